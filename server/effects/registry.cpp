#include "effects/registry.h"

#include <algorithm>

namespace helio::effects {
namespace {

using scene::kNone;

bool never(const scene::Material&) { return false; }
bool never(const scene::Environment&) { return false; }
bool never(const scene::Mesh&) { return false; }
bool never(const scene::Scene&) { return false; }

struct Row {
  const char* name;
  bool (*of_material)(const scene::Material&);
  bool (*of_environment)(const scene::Environment&);
  bool (*of_mesh)(const scene::Mesh&) = never;
  bool (*of_scene)(const scene::Scene&) = never;
};

constexpr std::array<Row, kEffects> kTable{{
    {"textures",
     [](const scene::Material& m) {
       return m.base_color_texture != kNone || m.normal_texture != kNone || m.metallic_roughness_texture != kNone ||
              m.emissive_texture != kNone || m.specular_texture != kNone || m.specular_color_texture != kNone;
     },
     never},
    {"normal_maps", [](const scene::Material& m) { return m.normal_texture != kNone && !m.lambert; }, never},
    {"emissive_triangles", [](const scene::Material& m) { return m.emission != glm::vec3(0.0f) || m.unlit; }, never},
    {"sun", never, [](const scene::Environment& e) { return e.sun.irradiance != glm::vec3(0.0f); }},
    {"sky_gradient", never, [](const scene::Environment& e) { return e.sky.zenith != e.sky.ground; }},
    {"mirrors", [](const scene::Material& m) { return m.roughness < kMirrorRoughness && !m.lambert; }, never},
    {"uv_channels", never, never, [](const scene::Mesh& m) { return !m.more_uvs.empty(); }},
    {"vertex_colors", never, never, [](const scene::Mesh& m) { return !m.colors.empty(); }},
    {"specular", [](const scene::Material& m) { return m.hasOwnSpecular(); }, never},
    {"unlit", [](const scene::Material& m) { return m.unlit; }, never},
    {"alpha_masks", [](const scene::Material& m) { return m.masked(); }, never},
    {"punctual_lights", never, never, never, [](const scene::Scene& s) { return !s.lights.empty(); }},
    {"deforming", never, never, [](const scene::Mesh& m) { return m.deforms(); }},
}};

}  // namespace

const char* name(Effect effect) { return kTable[static_cast<size_t>(effect)].name; }

gpu::Specialisation specialisation(EffectSet set) {
  gpu::Specialisation constants(kEffects);
  for (size_t i = 0; i < kEffects; ++i) constants[i] = set.has(static_cast<Effect>(i));
  return constants;
}

Registry::Registry(const scene::Scene& scene) {
  for (size_t i = 0; i < kEffects; ++i)
    if (kTable[i].of_scene(scene)) always_.add(static_cast<Effect>(i));
  for (const scene::Prefab& prefab : scene.prefabs) {
    EffectSet set;
    const scene::Mesh& mesh = scene.meshes[prefab.mesh];
    for (size_t i = 0; i < kEffects; ++i) {
      const auto calls = [&](const scene::Submesh& s) { return kTable[i].of_material(scene.materials[s.material]); };
      if (kTable[i].of_mesh(mesh) || std::any_of(mesh.submeshes.begin(), mesh.submeshes.end(), calls))
        set.add(static_cast<Effect>(i));
    }
    by_prefab_.push_back(set);
  }
}

void Registry::place(uint32_t prefab, int64_t count) {
  for (size_t i = 0; i < kEffects; ++i)
    if (by_prefab_[prefab].has(static_cast<Effect>(i))) instances_[i] += static_cast<uint64_t>(count);
}

EffectSet Registry::present(const scene::Environment& environment) const {
  EffectSet set = always_;
  for (size_t i = 0; i < kEffects; ++i)
    if (instances_[i] > 0 || kTable[i].of_environment(environment)) set.add(static_cast<Effect>(i));
  return set;
}

EffectSet Registry::possible(const scene::Environment& environment) const {
  EffectSet set = present(environment);
  for (const EffectSet& prefab : by_prefab_) set.bits |= prefab.bits;
  return set;
}

}  // namespace helio::effects
