#include "effects/registry.h"

#include <gtest/gtest.h>

#include "support/scenes.h"

namespace helio::effects {
namespace {

TEST(Registry, FindsExactlyWhatTheSceneCallsFor) {
  const scene::ScenePtr scene = test::stillLife();
  Registry registry(*scene);
  scene::Environment night;
  EXPECT_EQ(registry.present(night).bits, 0u) << "nothing is placed yet";
  for (const scene::Placement& placement : scene->placements) registry.place(placement.prefab, +1);
  const EffectSet all = registry.present(scene->environment);
  for (const Effect effect : {Effect::textures, Effect::normal_maps, Effect::emissive_triangles, Effect::sun,
                              Effect::sky_gradient, Effect::mirrors})
    EXPECT_TRUE(all.has(effect)) << name(effect);
  for (const Effect effect : {Effect::uv_channels, Effect::vertex_colors, Effect::specular, Effect::unlit})
    EXPECT_FALSE(all.has(effect)) << name(effect);
  EXPECT_EQ(registry.instances(Effect::normal_maps), 2u);

  const uint32_t lamp = scene->findPrefab("lamp");
  registry.place(lamp, -1);
  const EffectSet dark = registry.present(night);
  EXPECT_FALSE(dark.has(Effect::emissive_triangles));
  EXPECT_FALSE(dark.has(Effect::sun));
  EXPECT_TRUE(dark.has(Effect::textures));
  EXPECT_TRUE(registry.possible(night).has(Effect::emissive_triangles)) << "it could be built again";
}

/// What a plain quad calls for after `change` of its mesh and material.
template <typename Change>
EffectSet calledFor(Change&& change) {
  test::SceneBuilder b;
  scene::Mesh mesh = test::quad(1.0f);
  scene::Material material;
  change(mesh, material);
  b.place(b.prefab("quad", mesh, b.material(material)));
  Registry registry(*b.build());
  registry.place(0, +1);
  return registry.present({});
}

TEST(Registry, WhatOnlySomeModelsHave) {
  using scene::Material;
  using scene::Mesh;
  const auto only = [](Effect effect) {
    EffectSet set;
    set.add(effect);
    return set;
  };
  EXPECT_EQ(calledFor([](Mesh&, Material&) {}), EffectSet{});
  EXPECT_EQ(calledFor([](Mesh& mesh, Material&) { mesh.colors.resize(4); }), only(Effect::vertex_colors));
  EXPECT_EQ(calledFor([](Mesh& mesh, Material&) { mesh.more_uvs.assign(1, mesh.uvs); }), only(Effect::uv_channels));
  EXPECT_EQ(calledFor([](Mesh&, Material& m) { m.ior = 1.33f; }), only(Effect::specular));
  EffectSet shining = only(Effect::unlit);  // an emitter that light sampling does not look for
  shining.add(Effect::emissive_triangles);
  EXPECT_EQ(calledFor([](Mesh&, Material& m) { m.unlit = true; }), shining);
}

TEST(Registry, SpecialisesByPosition) {
  EffectSet set;
  set.add(Effect::sun);
  const gpu::Specialisation constants = specialisation(set);
  for (size_t i = 0; i < kEffects; ++i) EXPECT_EQ(constants[i], i == static_cast<size_t>(Effect::sun));
}

}  // namespace
}  // namespace helio::effects
