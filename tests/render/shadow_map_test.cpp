// The sun's shadow map says what rays say, but for the edges of shadows; and it is there only when somebody asks for
// it.
#include <cmath>
#include <cstdio>

#include "render/passes/shadow_map.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::SunShadow;

render::ViewSettings settingsWith(SunShadow shadow) {
  render::ViewSettings settings;
  settings.width = 160;
  settings.height = 90;
  settings.bounces = 0;
  settings.accumulate = false;
  settings.auto_exposure = false;
  settings.keep_radiance = true;
  settings.sun_shadow = shadow;
  settings.shadow_map_size = 1024;
  return settings;
}

/// Boxes and balls near and far on a plane, under a small sun and a dim sky.
scene::ScenePtr yard() {
  SceneBuilder builder;
  builder.environment().sun = {glm::normalize(glm::vec3(-0.7f, -1.0f, -0.4f)), glm::vec3(3.0f), 0.001f};
  builder.environment().sky = {glm::vec3(0.1f), glm::vec3(0.1f)};
  const uint32_t white = builder.material(lambert(glm::vec3(0.6f)));
  const uint32_t ground = builder.prefab("ground", quad(400.0f), white), box = builder.prefab("box", cube(), white),
                 ball = builder.prefab("ball", sphere(16), white);
  builder.place(ground);
  for (int i = 0; i < 40; ++i) {
    const float away = 2.0f * std::exp(0.1f * static_cast<float>(i));
    const glm::vec3 where(away * 0.6f * std::sin(1.9f * static_cast<float>(i)), 0.6f, -away);
    builder.place(i % 2 ? ball : box, at(where, 0.5f + 0.03f * away));
  }
  return builder.build();
}

const scene::Camera kCamera = lookAt({0, 4.0f, 5.0f}, {0, 0, -14.0f}, 0.9f);

TEST(ShadowMap, AgreesWithRaysOnAllButTheEdgesOfShadows) {
  Stage stage(yard());
  const render::Frame rays = stage.tick(kCamera, settingsWith(SunShadow::rays)),
                      map = stage.tick(kCamera, settingsWith(SunShadow::map));
  showPicture(rays, "shadow_rays");
  showPicture(map, "shadow_map");
  EXPECT_EQ(map.stats.nonfinite, 0u);
  EXPECT_LT(map.stats.rays.shadow, rays.stats.rays.shadow / 4);  // scattered paths aside
  const auto lit = [](const render::Frame& frame, uint32_t x, uint32_t y) { return texel(frame, x, y).g; };
  size_t compared = 0, different = 0, shaded = 0;
  for (uint32_t y = 1; y + 1 < 90; ++y) {
    for (uint32_t x = 1; x + 1 < 160; ++x) {
      float low = 1e9f, high = 0.0f;
      for (uint32_t j = y - 1; j <= y + 1; ++j)
        for (uint32_t i = x - 1; i <= x + 1; ++i) {
          low = std::min(low, lit(rays, i, j));
          high = std::max(high, lit(rays, i, j));
        }
      if (high > 1.5f * low + 0.08f) continue;  // an edge; the sky's light is noise of 0.06
      ++compared;
      shaded += lit(rays, x, y) < 0.15f;
      different += std::abs(lit(rays, x, y) - lit(map, x, y)) > 0.15f;
    }
  }
  EXPECT_GT(compared, 8'000u);
  EXPECT_GT(shaded, 100u);
  EXPECT_LT(static_cast<double>(different) / static_cast<double>(compared), 0.005);
}

// Where rays meet everything the map has nothing to add. First ticks draw the same random numbers.
TEST(ShadowMap, TogetherWithRaysItDrawsWhatTheyDoNotMeet) {
  const render::Frame rays = Stage(yard()).tick(kCamera, settingsWith(SunShadow::rays)),
                      both = Stage(yard()).tick(kCamera, settingsWith(SunShadow::rays_and_map));
  EXPECT_EQ(both.stats.shadow_triangles, 0u);
  for (size_t i = 0; i < rays.radiance.size(); ++i) ASSERT_NEAR(both.radiance[i], rays.radiance[i], 1e-5f) << i;

  Stage culled(yard());
  render::CullingSettings near_alone;
  near_alone.radius = 12.0f;
  culled.setCulling(render::Culling::distance, near_alone);
  const render::Frame rest = culled.tick(kCamera, settingsWith(SunShadow::rays_and_map));
  const render::Frame without = culled.tick(kCamera, settingsWith(SunShadow::rays));
  EXPECT_GT(rest.stats.shadow_triangles, 0u);
  const auto brighter = [&](const render::Frame& frame) {
    size_t count = 0;
    for (size_t i = 0; i < rays.radiance.size(); ++i) count += frame.radiance[i] > 1.5f * rays.radiance[i] + 0.1f;
    return count;
  };
  std::printf("%zu channels have a shadow less by rays alone, %zu with the map\n", brighter(without), brighter(rest));
  EXPECT_GT(brighter(without), 100u);
  EXPECT_LT(brighter(rest), brighter(without) / 5);
}

TEST(ShadowMap, InThePlaceOfRaysItDrawsWhatTheyMeetToo) {
  Stage full(yard()), guided(yard());
  guided.setCulling(render::Culling::lipac);
  const render::Frame expected = full.accumulate(kCamera, settingsWith(SunShadow::map), 3),
                      shown = guided.accumulate(kCamera, settingsWith(SunShadow::map), 3);
  ASSERT_GT(shown.stats.lipac->active, 10u);
  EXPECT_EQ(shown.stats.shadow_triangles, expected.stats.shadow_triangles);
  EXPECT_LT(std::abs(mean(shown).g / mean(expected).g - 1.0f), 0.02f);
}

TEST(ShadowMap, IsDrawnOnlyWhenSomethingAsksForIt) {
  Stage stage(yard());
  EXPECT_FALSE(recorded(stage.tick(kCamera, settingsWith(SunShadow::rays)), "shadow_map"));
  EXPECT_TRUE(recorded(stage.tick(kCamera, settingsWith(SunShadow::map)), "shadow_map"));
  EXPECT_FALSE(recorded(stage.tick(kCamera, referenceSettings()), "shadow_map"));
  scene::Scene dark = *yard();
  dark.environment.sun.irradiance = glm::vec3(0.0f);
  Stage night(std::make_shared<scene::Scene>(std::move(dark)));
  EXPECT_FALSE(recorded(night.tick(kCamera, settingsWith(SunShadow::map)), "shadow_map"));
}

TEST(ShadowMap, CascadesGrowHoldTheirPlaceAndReachTheWholeWorld) {
  const glm::vec3 to_sun = glm::normalize(glm::vec3(0.3f, 0.8f, -0.2f));
  const accel::OrderBlock world{{100.0f, 0.0f, -50.0f}, 900.0f};
  const shared::ShadowMap map = render::shadowCascades(kCamera, to_sun, world, 1024);
  const shared::ShadowCascade& last = map.cascades[shared::kShadowCascades - 1];
  EXPECT_GT(last.half_width, world.radius);
  EXPECT_LT(glm::distance(last.centre, world.centre), 0.01f * last.half_width);
  for (uint32_t c = 1; c < shared::kShadowCascades; ++c)
    EXPECT_GT(map.cascades[c].half_width, 2.0f * map.cascades[c - 1].half_width);
  EXPECT_NEAR(glm::dot(map.right, map.up), 0.0f, 1e-6f);
  EXPECT_NEAR(glm::dot(map.right, to_sun), 0.0f, 1e-6f);
  // A camera that moves by less than a texel moves the lattice by whole ones.
  scene::Camera moved = kCamera;
  moved.position += glm::vec3(0.013f, 0.0f, 0.021f);
  const shared::ShadowMap then = render::shadowCascades(moved, to_sun, world, 1024);
  for (uint32_t c = 0; c < shared::kShadowCascades; ++c) {
    const float texel = 2.0f * map.cascades[c].half_width / 1024.0f;
    for (const glm::vec3& axis : {map.right, map.up}) {
      const float steps = glm::dot(then.cascades[c].centre - map.cascades[c].centre, axis) / texel;
      EXPECT_NEAR(steps, std::round(steps), 0.02f);
    }
  }
}

}  // namespace
}  // namespace helio::test
