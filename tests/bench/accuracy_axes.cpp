#include <functional>
#include <map>

#include "bench/accuracy.h"
#include "render/ladder.h"

namespace helio::bench {
namespace {

using render::ViewSettings;

/// A name and what it changes.
struct Step {
  std::string name;
  std::function<void(AccuracySetting&)> change;
};

template <typename T, typename F>
std::vector<Step> steps(std::initializer_list<T> values, F ViewSettings::*field) {
  std::vector<Step> made;
  for (const T value : values) {
    std::string name = std::to_string(value);
    if constexpr (std::is_floating_point_v<T>) name = fixed(value, 1);
    made.push_back({name, [value, field](AccuracySetting& s) { s.view.*field = static_cast<F>(value); }});
  }
  return made;
}

Step view(const std::string& name, const std::function<void(ViewSettings&)>& change) {
  return {name, [change](AccuracySetting& s) { change(s.view); }};
}

void denoise(ViewSettings& view) { view.denoiser = render::Denoiser::svgf, view.taa = true; }

/// What is left then is no noise: live pictures are off by so much, whatever a denoiser does.
void converge(ViewSettings& view) {
  view.primary = render::Primary::traced;  // a tick's samples each have their own place in the pixel
  view.samples = 64;
  view.accumulate = true;
}

/// What the controller chooses among.
std::vector<Step> ladder() {
  std::vector<Step> rungs;
  for (size_t rung = 0; rung < render::kRungs; ++rung)
    rungs.push_back(view(render::kLadder[rung].name, [rung](ViewSettings& v) { v = render::onRung(v, rung); }));
  return rungs;
}

const std::vector<std::pair<std::string, std::vector<Step>>>& table() {
  using render::Ambient, render::Culling, render::Denoiser, render::IndirectRate, render::Primary,
      render::Reconstruction, render::Sampler, render::SunShadow, render::Technique;
  static const std::vector<std::pair<std::string, std::vector<Step>>> axes{
      {"spp", steps({1, 2, 4, 8}, &ViewSettings::samples)},
      {"bounces", steps({0, 1, 2, 3, 5}, &ViewSettings::bounces)},
      {"roulette",
       {view("on", [](ViewSettings& v) { v.roulette = true; }),
        view("off", [](ViewSettings& v) { v.roulette = false; })}},
      {"denoiser",
       {view("none", [](ViewSettings&) {}), view("average", [](ViewSettings& v) { v.accumulate = true; }),
        view("svgf", [](ViewSettings& v) { v.denoiser = Denoiser::svgf; }),
        view("asvgf", [](ViewSettings& v) { v.denoiser = Denoiser::asvgf; }),
        view("reblur", [](ViewSettings& v) { v.denoiser = Denoiser::reblur; })}},
      {"taa",
       {view("off", [](ViewSettings&) {}), view("on", [](ViewSettings& v) { v.taa = true; }),
        view("svgf", [](ViewSettings& v) { v.denoiser = Denoiser::svgf; }),
        view("svgf_taa", [](ViewSettings& v) { v.denoiser = Denoiser::svgf, v.taa = true; }),
        view("asvgf_taa", [](ViewSettings& v) { v.denoiser = Denoiser::asvgf, v.taa = true; })}},
      {"cold",
       {view("none", denoise), view("samples_2", [](ViewSettings& v) { denoise(v), v.samples = 2; }),
        view("extra_0.5", [](ViewSettings& v) { denoise(v), v.extra_samples = 0.5f; }),
        view("extra_1", [](ViewSettings& v) { denoise(v), v.extra_samples = 1.0f; }),
        view("extra_2", [](ViewSettings& v) { denoise(v), v.extra_samples = 2.0f; })}},
      {"primary",
       {view("raster", [](ViewSettings& v) { v.primary = Primary::raster; }),
        view("traced", [](ViewSettings& v) { v.primary = Primary::traced; })}},
      {"culling",
       {{"lipac", [](AccuracySetting& s) { s.culling = Culling::lipac; }},
        {"lipac_and_map",
         [](AccuracySetting& s) { s.culling = Culling::lipac, s.view.sun_shadow = SunShadow::rays_and_map; }},
        {"frustum_radius", [](AccuracySetting& s) { s.culling = Culling::frustum_radius; }},
        {"full", [](AccuracySetting&) {}}}},
      {"lights",
       {view("one", [](ViewSettings&) {}), view("four", [](ViewSettings& v) { v.lamp_samples = 4; }),
        view("all", [](ViewSettings& v) { v.lamp_samples = 0; })}},
      {"light_lists",
       {view("off", [](ViewSettings& v) { v.light_lists = false; }),
        view("on", [](ViewSettings& v) { v.light_lists = true; }),
        view("learned", [](ViewSettings& v) { v.light_feedback = true; }),
        view("all_lamps", [](ViewSettings& v) { v.light_lists = false, v.lamp_samples = 0; }),
        view("all_learned", [](ViewSettings& v) { v.light_feedback = true, v.lamp_samples = 0; })}},
      {"mode",
       {view("whitted", [](ViewSettings& v) { v.technique = Technique::whitted, v.ambient = Ambient::constant; }),
        view("distributed", [](ViewSettings& v) { v.technique = Technique::distributed; }),
        view("distributed_ambient",
             [](ViewSettings& v) { v.technique = Technique::distributed, v.ambient = Ambient::constant; }),
        view("path_traced", [](ViewSettings&) {})}},
      {"rate",
       {view("constant", [](ViewSettings& v) { v.technique = Technique::distributed, v.ambient = Ambient::constant; }),
        view("occlusion", [](ViewSettings& v) { v.technique = Technique::distributed, v.ambient = Ambient::occluded; }),
        view("quarter_bilateral",
             [](ViewSettings& v) {
               v.indirect_rate = IndirectRate::quarter, v.reconstruction = Reconstruction::bilateral;
             }),
        view("quarter", [](ViewSettings& v) { v.indirect_rate = IndirectRate::quarter; }),
        view("half_bilateral",
             [](ViewSettings& v) {
               v.indirect_rate = IndirectRate::half, v.reconstruction = Reconstruction::bilateral;
             }),
        view("half", [](ViewSettings& v) { v.indirect_rate = IndirectRate::half; }),
        view("full", [](ViewSettings&) {})}},
      {"light_sampling",
       {view("scattering", [](ViewSettings& v) { v.light_sampling = false; }),
        view("lights", [](ViewSettings& v) { v.mis = false; }), view("both", [](ViewSettings&) {})}},
      {"shadow",
       {view("map", [](ViewSettings& v) { v.sun_shadow = SunShadow::map; }),
        view("rays_and_map", [](ViewSettings& v) { v.sun_shadow = SunShadow::rays_and_map; }),
        view("rays", [](ViewSettings&) {})}},
      {"detail",
       {view("levels", [](ViewSettings& v) { v.levels_of_detail = true; }),
        view("finest", [](ViewSettings& v) { v.levels_of_detail = false; }),
        view("levels_converged", [](ViewSettings& v) { v.levels_of_detail = true, converge(v); }),
        view("finest_converged", [](ViewSettings& v) { v.levels_of_detail = false, converge(v); })}},
      {"sampler",
       {view("independent", [](ViewSettings& v) { v.sampler = Sampler::independent; }),
        view("low_discrepancy", [](ViewSettings&) {})}},
      {"regularisation", steps({0.6, 0.3, 0.0}, &ViewSettings::regularisation)},
      {"preset", ladder()}};
  return axes;
}

}  // namespace

const std::vector<std::string>& accuracyAxes() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& [name, steps] : table()) list.push_back(name);
    return list;
  }();
  return names;
}

ViewSettings baseSettings(uint32_t width, uint32_t height) {
  ViewSettings view;
  view.width = width;
  view.height = height;
  view.accumulate = false;
  view.auto_exposure = false;
  view.keep_radiance = true;
  return view;
}

Result<std::vector<AccuracySetting>> settingsOf(const std::string& axis, const ViewSettings& base) {
  for (const auto& [name, steps] : table()) {
    if (name != axis) continue;
    std::vector<AccuracySetting> settings;
    for (const Step& step : steps) {
      settings.push_back({axis, step.name, base, {}});
      step.change(settings.back());
    }
    return settings;
  }
  std::string known;
  for (const std::string& name : accuracyAxes()) known += ", " + name;
  return invalid("--axis", axis, "there is no axis \"" + axis + "\": give all" + known);
}

}  // namespace helio::bench
