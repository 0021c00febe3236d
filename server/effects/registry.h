// Which effects a scene calls for: found at load and at each edit, by counting. Shaders are specialised for exactly
// that, and a pass that nothing calls for is not recorded. A new effect is one more row of the table in registry.cpp
// and one more constant in shaders/lib/effects.glsl.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gpu/pipelines.h"
#include "scene/scene.h"

namespace helio::effects {

/// In the order of the specialisation constants of shaders/lib/effects.glsl.
enum class Effect : uint32_t {
  textures,
  normal_maps,
  emissive_triangles,
  sun,
  sky_gradient,
  mirrors,
  uv_channels,
  vertex_colors,
  specular,
  unlit,
  alpha_masks,
  punctual_lights,
  deforming
};
inline constexpr size_t kEffects = 13;

/// A set of effects as bits.
struct EffectSet {
  uint32_t bits = 0;
  bool has(Effect effect) const { return (bits >> static_cast<uint32_t>(effect) & 1u) != 0; }
  void add(Effect effect) { bits |= 1u << static_cast<uint32_t>(effect); }
  /// Those of them that are `effect`, for shaders that know no other.
  EffectSet only(Effect effect) const { return {bits & 1u << static_cast<uint32_t>(effect)}; }
  friend bool operator==(EffectSet a, EffectSet b) { return a.bits == b.bits; }
};

const char* name(Effect effect);

/// Specialisation constants 0 .. kEffects - 1.
gpu::Specialisation specialisation(EffectSet set);

/// Perceptual roughness below which a material is a mirror (alpha < kMirrorAlpha of shaders/lib/bsdf.glsl).
inline constexpr float kMirrorRoughness = 0.0316f;

/// Counts what the live instances of one world call for.
class Registry {
 public:
  explicit Registry(const scene::Scene& scene);

  /// An instance of `prefab` was placed (`count` = +1) or removed (-1).
  void place(uint32_t prefab, int64_t count);

  /// What the instances now placed and this light call for.
  EffectSet present(const scene::Environment& environment) const;
  /// What any prefab of the scene could call for, if it were built under this light.
  EffectSet possible(const scene::Environment& environment) const;
  /// Live instances that call for `effect` (0 for those of the environment).
  uint64_t instances(Effect effect) const { return instances_[static_cast<size_t>(effect)]; }

 private:
  EffectSet always_;  // what the scene calls for whatever is placed
  std::vector<EffectSet> by_prefab_;
  std::array<uint64_t, kEffects> instances_{};
};

}  // namespace helio::effects
