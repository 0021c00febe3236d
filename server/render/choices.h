// What a view may choose, by the names that the wire, command lines and benchmarks share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "render/renderer.h"

namespace helio::render {

/// `name` is that of the value in C++; on the wire it is in capitals, with the enumeration's name before it.
template <typename Value>
struct Choice {
  const char* name;
  Value value;
};

inline constexpr Choice<Mode> kModes[] = {
    {"hybrid", Mode::hybrid},
    {"reference", Mode::reference},
};

inline constexpr Choice<Primary> kPrimaries[] = {
    {"raster", Primary::raster},
    {"traced", Primary::traced},
};

inline constexpr Choice<SunShadow> kSunShadows[] = {
    {"rays", SunShadow::rays},
    {"rays_and_map", SunShadow::rays_and_map},
    {"map", SunShadow::map},
};

inline constexpr Choice<Denoiser> kDenoisers[] = {
    {"none", Denoiser::none},
    {"svgf", Denoiser::svgf},
    {"asvgf", Denoiser::asvgf},
    {"reblur", Denoiser::reblur},
};

inline constexpr Choice<Technique> kTechniques[] = {
    {"path_traced", Technique::path_traced},
    {"distributed", Technique::distributed},
    {"whitted", Technique::whitted},
};

inline constexpr Choice<Ambient> kAmbients[] = {
    {"none", Ambient::none},
    {"constant", Ambient::constant},
    {"occluded", Ambient::occluded},
};

inline constexpr Choice<IndirectRate> kIndirectRates[] = {
    {"full", IndirectRate::full},
    {"half", IndirectRate::half},
    {"quarter", IndirectRate::quarter},
};

inline constexpr Choice<Reconstruction> kReconstructions[] = {
    {"reuse", Reconstruction::reuse},
    {"bilateral", Reconstruction::bilateral},
};

inline constexpr Choice<Inspect> kInspects[] = {
    {"nothing", Inspect::nothing},   {"motion", Inspect::motion},         {"position", Inspect::position},
    {"before", Inspect::before},     {"unfiltered", Inspect::unfiltered}, {"diffuse", Inspect::diffuse},
    {"specular", Inspect::specular}, {"samples", Inspect::samples},
};

inline constexpr Choice<CullingView> kCullingViews[] = {
    {"none", CullingView::none},         {"states", CullingView::states}, {"hitboxes", CullingView::hitboxes},
    {"untraced", CullingView::untraced}, {"rays", CullingView::rays},     {"above", CullingView::above},
};

template <typename Value, size_t N>
std::vector<std::string> namesOf(const Choice<Value> (&choices)[N]) {
  std::vector<std::string> names;
  for (const auto& choice : choices) names.emplace_back(choice.name);
  return names;
}

template <typename Value, size_t N>
std::optional<Value> byName(const Choice<Value> (&choices)[N], const std::string& name) {
  for (const auto& choice : choices)
    if (name == choice.name) return choice.value;
  return std::nullopt;
}

}  // namespace helio::render
