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
  for (size_t i = 0; i < kEffects; ++i) EXPECT_TRUE(all.has(static_cast<Effect>(i))) << name(static_cast<Effect>(i));
  EXPECT_EQ(registry.instances(Effect::normal_maps), 2u);

  const uint32_t lamp = scene->findPrefab("lamp");
  registry.place(lamp, -1);
  const EffectSet dark = registry.present(night);
  EXPECT_FALSE(dark.has(Effect::emissive_triangles));
  EXPECT_FALSE(dark.has(Effect::sun));
  EXPECT_TRUE(dark.has(Effect::textures));
  EXPECT_TRUE(registry.possible(night).has(Effect::emissive_triangles)) << "it could be built again";
}

TEST(Registry, SpecialisesByPosition) {
  EffectSet set;
  set.add(Effect::sun);
  const gpu::Specialisation constants = specialisation(set);
  for (size_t i = 0; i < kEffects; ++i) EXPECT_EQ(constants[i], i == static_cast<size_t>(Effect::sun));
}

}  // namespace
}  // namespace helio::effects
