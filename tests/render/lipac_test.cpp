// Light path guided culling in pictures: it holds what paths meet, the same in every run, and gives back what it took.
#include <algorithm>
#include <cmath>

#include "scene/city.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Culling;

render::ViewSettings small(uint32_t width = 96, uint32_t height = 54) {
  render::ViewSettings settings;
  settings.width = width;
  settings.height = height;
  settings.accumulate = false;
  settings.auto_exposure = false;
  return settings;
}

const scene::Camera& cameraOf(const scene::Scene& scene, const std::string& name) {
  return std::find_if(scene.cameras.begin(), scene.cameras.end(), [&](const auto& c) { return c.name == name; })
      ->camera;
}

uint32_t all(const accel::LipacFigures& f) { return f.inactive + f.omitted + f.requested + f.active; }

/// Mean over pixels of |a - b|, over the mean of b.
double difference(const render::Frame& a, const render::Frame& b) {
  double sum = 0.0, whole = 0.0;
  for (size_t i = 0; i < a.radiance.size(); ++i) {
    sum += std::abs(static_cast<double>(a.radiance[i]) - static_cast<double>(b.radiance[i]));
    whole += static_cast<double>(b.radiance[i]);
  }
  return sum / whole;
}

/// Mean over pixels of the squared difference over the square of b, as far as that is not black.
double squaredError(const render::Frame& a, const render::Frame& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.radiance.size(); ++i) {
    const double truth = b.radiance[i], off = static_cast<double>(a.radiance[i]) - truth;
    sum += off * off / (truth * truth + 1e-4);
  }
  return sum / static_cast<double>(a.radiance.size());
}

/// Brings a view to the time and the samples of another that ticked so often.
void keepUp(Stage& stage, const scene::Camera& camera, uint32_t ticks) {
  (void)stage.accumulate(camera, small(16, 16), ticks);
}

/// The mean of 32 samples while time stands.
render::Frame still(Stage& stage, const scene::Camera& camera, render::ViewSettings settings) {
  stage.setStep(0.0);
  settings.accumulate = settings.keep_radiance = true;
  settings.samples = 16;
  return stage.accumulate(camera, settings, 2);
}

TEST(Lipac, HoldsWhatLightPathsMeetAndLittleElse) {
  const scene::ScenePtr city = *scene::generateCity({1, 1'000, 200});
  const scene::Camera camera = cameraOf(*city, "tilted_city");
  Stage full(city), guided(city), none(city);
  guided.setCulling(Culling::lipac);
  none.setCulling(Culling::none);
  const auto count = static_cast<uint32_t>(city->placements.size());
  for (int tick = 0; tick < 24; ++tick) {
    const render::Frame frame = guided.tick(camera, small());
    ASSERT_TRUE(frame.stats.lipac.has_value());
    const accel::LipacFigures& f = *frame.stats.lipac;
    EXPECT_EQ(all(f), count) << "tick " << tick;
    EXPECT_EQ(f.dropped, 0u) << "tick " << tick;
    // Commands, what is granted, what deforms and blocks, never all instances. (The first tick's edits place them all.)
    EXPECT_LE(f.cpu_visits, (tick == 0 ? count : 0u) + 3u * 200u + count / 64u + 1u) << "tick " << tick;
  }
  keepUp(full, camera, 24);
  keepUp(none, camera, 24);
  const render::Frame a = still(full, camera, small()), b = still(guided, camera, small()),
                      c = still(none, camera, small());
  showPicture(a, "lipac_full");
  showPicture(b, "lipac_guided");
  showPicture(c, "lipac_none");
  const accel::LipacFigures& f = *b.stats.lipac;
  EXPECT_GT(f.active, 20u);
  EXPECT_LT(f.active, count * 4 / 5);  // a small town: half of it is in view
  EXPECT_LT(f.entries, count);
  EXPECT_LT(b.stats.acceleration.own_blases, a.stats.acceleration.own_blases / 2);
  // A quarter in squares, as the large town is judged.
  EXPECT_LT(4.0 * squaredError(b, a), squaredError(c, a));
  EXPECT_GT(difference(c, a), 0.01);  // the control fails

  // A reference view knows no approximation, and states wait for it.
  EXPECT_EQ(guided.tick(camera, referenceSettings()).stats.tlas_instances, count);
  const render::Frame after = guided.tick(camera, small());
  // By one tick's changes, and what was granted before it.
  EXPECT_LE(std::abs(static_cast<int>(after.stats.lipac->active) - static_cast<int>(f.active)),
            static_cast<int>(after.stats.lipac->changes + after.stats.lipac->served));
}

TEST(Lipac, TheSameTicksGiveTheSameBytes) {
  const scene::ScenePtr city = *scene::generateCity({3, 1'000, 200});
  Stage first(city), second(city);
  for (Stage* stage : {&first, &second}) stage->setCulling(Culling::lipac);
  scene::Camera camera = cameraOf(*city, "tilted_city");
  for (int tick = 0; tick < 12; ++tick) {
    camera.position += glm::vec3(0.6f, 0.0f, 0.4f);
    const render::Frame a = first.tick(camera, small(64, 36)), b = second.tick(camera, small(64, 36));
    ASSERT_EQ(bytes(a), bytes(b)) << "tick " << tick;
    const accel::LipacFigures x = *a.stats.lipac, y = *b.stats.lipac;
    ASSERT_EQ(std::tie(x.inactive, x.omitted, x.requested, x.active, x.entries, x.served),
              std::tie(y.inactive, y.omitted, y.requested, y.active, y.entries, y.served))
        << "tick " << tick;
  }
}

TEST(Lipac, RasterShowsTheSameWhateverTheTlasHolds) {
  const scene::ScenePtr city = *scene::generateCity({1, 1'000, 100});
  const scene::Camera camera = cameraOf(*city, "animated_models");
  Stage full(city), none(city);
  none.setCulling(Culling::none);
  render::ViewSettings settings = small();
  settings.materials = render::MaterialOverride::instances;
  for (int tick = 0; tick < 3; ++tick)
    EXPECT_EQ(bytes(full.tick(camera, settings)), bytes(none.tick(camera, settings))) << "tick " << tick;
}

/// Walkers on a plain.
scene::ScenePtr crowd(uint32_t count) {
  static const scene::ScenePtr city = *scene::generateCity({1, 1'000, 100});
  scene::Scene scene = *city;
  scene.placements.clear();
  scene.routes.clear();
  scene.ground = {};
  const uint32_t walker = scene.findPrefab("walker_smith");
  for (uint32_t i = 0; i < count; ++i)
    scene.placements.push_back(
        {walker, at({1.5f * static_cast<float>(i % 8) - 5.0f, 0.0f, -1.5f * static_cast<float>(i / 8)})});
  return std::make_shared<scene::Scene>(std::move(scene));
}

const scene::Camera kAtTheCrowd = lookAt({0, 6, 9}, {0, 0, -3}, 0.8f);
const scene::Camera kAtTheSky = lookAt({0, 2, 40}, {0, 40, 80}, 0.8f);

TEST(Lipac, BlasesComeWithinTheBudgetAndGoWithoutATrace) {
  Stage stage(crowd(40));
  render::CullingSettings settings;
  settings.builds = 2;
  settings.lipac.mitigation = false;
  stage.setCulling(Culling::lipac, settings);
  uint32_t served = 0, most_left = 0, waited = 0;
  for (int tick = 0; tick < 60; ++tick) {
    const render::Frame frame = stage.tick(kAtTheCrowd, small());
    const accel::LipacFigures& f = *frame.stats.lipac;
    EXPECT_LE(f.served, 2u) << "tick " << tick;
    served += f.served;
    most_left = std::max(most_left, f.left_over);
    waited += f.requested > 0;
    // What is active is in the TLAS, in the same tick.
    EXPECT_LE(frame.stats.acceleration.own_blases, served);
  }
  EXPECT_GT(most_left, 2u);
  EXPECT_GT(waited, 3u);  // they stayed requested, drawn and counted, until their turn
  const render::Frame settled = stage.tick(kAtTheCrowd, small());
  EXPECT_EQ(settled.stats.lipac->requested, 0u);
  EXPECT_EQ(settled.stats.lipac->active, settled.stats.acceleration.own_blases);
  EXPECT_GT(settled.stats.lipac->active, 20u);

  uint64_t rest = 0;
  for (int round = 0; round < 2; ++round) {
    const render::Frame frame = stage.accumulate(kAtTheSky, small(32, 18), 240);
    EXPECT_EQ(frame.stats.lipac->inactive, 40u);
    EXPECT_EQ(frame.stats.acceleration.own_blases, 0u);
    EXPECT_EQ(frame.stats.acceleration.own_blas_bytes, 0u);
    EXPECT_EQ(frame.stats.acceleration.own_vertex_bytes, 0u);
    if (round == 1) { EXPECT_EQ(frame.stats.acceleration.total(), rest); }
    rest = frame.stats.acceleration.total();
    EXPECT_GT(stage.accumulate(kAtTheCrowd, small(), 20).stats.acceleration.own_blases, 5u);
  }
}

TEST(Lipac, AnInstanceThatIsMovedStaysAndOneThatGoesIsForgotten) {
  Stage stage(crowd(16));
  stage.setCulling(Culling::lipac);
  const render::Frame before = stage.accumulate(kAtTheCrowd, small(), 40);
  const uint32_t held = before.stats.lipac->active;
  ASSERT_GT(held, 10u);
  stage.edit({world::Move{1, {glm::vec3(0.5f, 0.0f, 0.5f), glm::quat(1, 0, 0, 0), 1.0f}}});
  EXPECT_EQ(stage.tick(kAtTheCrowd, small()).stats.acceleration.own_blases, held);
  stage.edit({world::Destroy{{1, 2}}});
  const render::Frame after = stage.tick(kAtTheCrowd, small());
  EXPECT_EQ(after.stats.acceleration.own_blases, held - 2);
  EXPECT_EQ(after.stats.lipac->active, held - 2);
}

TEST(Lipac, BlasesThatAreSharedComeAndGoWithTheLight) {
  const scene::ScenePtr city = *scene::generateCity({1, 1'000, 0});
  const scene::Camera camera = cameraOf(*city, "tilted_city");
  Stage full(city), stage(city);
  render::CullingSettings settings;
  settings.shared_blases.age_limit = 20;
  settings.builds = 4;
  stage.setCulling(Culling::lipac, settings);
  const render::AccelerationUse everything = full.tick(camera, small(16, 16)).stats.acceleration;
  EXPECT_EQ(everything.shared_blases_waiting, 0u);

  // Terrain and the like at once, then what light paths meet, a few in a tick.
  EXPECT_GT(stage.tick(camera, small()).stats.acceleration.shared_blases, 0u);
  uint32_t waited = 0;
  render::Frame frame;
  for (int tick = 1; tick < 40; ++tick) {
    frame = stage.tick(camera, small());
    EXPECT_LE(frame.stats.acceleration.shared_blases_built, 4u) << "tick " << tick;
    waited += frame.stats.acceleration.shared_blases_waiting > 0;
  }
  EXPECT_GT(waited, 0u);
  EXPECT_EQ(frame.stats.acceleration.shared_blases_waiting, 0u);
  EXPECT_EQ(frame.stats.lipac->requested, 0u);
  const uint32_t held = frame.stats.acceleration.shared_blases;
  EXPECT_LT(held, everything.shared_blases);
  EXPECT_LT(frame.stats.acceleration.shared_blas_bytes, everything.shared_blas_bytes);

  // Where nothing is met all but that goes; it comes again, and takes what it took.
  const scene::Camera away =
      lookAt(camera.position + glm::vec3(0, 400, 0), camera.position + glm::vec3(0, 800, 100), 0.4f);
  uint64_t rest = 0;
  render::ViewSettings averaging = small(32, 18);
  averaging.accumulate = true;
  for (int round = 0; round < 2; ++round) {
    frame = stage.accumulate(away, averaging, 140);
    EXPECT_LT(2 * frame.stats.acceleration.shared_blases, held);
    EXPECT_GE(frame.stats.accumulated, 139u) << "what nobody needs is in no average";
    if (round == 1) { EXPECT_EQ(frame.stats.acceleration.shared_blas_bytes, rest); }
    rest = frame.stats.acceleration.shared_blas_bytes;
    frame = stage.accumulate(camera, small(), 40);
    EXPECT_NEAR(frame.stats.acceleration.shared_blases, held, held / 10 + 1);
  }
  // A reference view needs all of them.
  EXPECT_EQ(stage.tick(camera, referenceSettings()).stats.acceleration.shared_blas_bytes, everything.shared_blas_bytes);
}

TEST(Lipac, BothWaysThroughBoxesHoldTheSame) {
  const scene::ScenePtr city = *scene::generateCity({1, 1'000, 100});
  const scene::Camera camera = cameraOf(*city, "tilted_city");
  Stage closest(city), any(city), few(city);
  render::CullingSettings settings;
  settings.lipac.mitigation = false;  // or hardly any boxes would be left to meet
  closest.setCulling(Culling::lipac, settings);
  settings.lipac.box_hits = accel::BoxHits::any_hit;
  any.setCulling(Culling::lipac, settings);
  settings.lipac.counted_paths = 1'296;  // a quarter of them
  few.setCulling(Culling::lipac, settings);
  accel::LipacFigures a, b, c;
  // Before anything is culled all rays meet the same boxes. What a shadow ray meets before it ends is not settled.
  a = *closest.tick(camera, small()).stats.lipac;
  b = *any.tick(camera, small()).stats.lipac;
  c = *few.tick(camera, small()).stats.lipac;
  EXPECT_GT(a.box_hits, 10'000u);
  EXPECT_NEAR(static_cast<double>(b.box_hits), static_cast<double>(a.box_hits), 0.05 * static_cast<double>(a.box_hits));
  EXPECT_NEAR(static_cast<double>(c.box_hits), static_cast<double>(b.box_hits), 0.2 * static_cast<double>(b.box_hits));
  for (int tick = 1; tick < 24; ++tick) {
    a = *closest.tick(camera, small()).stats.lipac;
    b = *any.tick(camera, small()).stats.lipac;
    c = *few.tick(camera, small()).stats.lipac;
  }
  EXPECT_GT(a.active, 20u);
  EXPECT_NEAR(b.active, a.active, a.active / 10);
  EXPECT_NEAR(c.active, a.active, a.active / 5);
}

TEST(Lipac, BoxesChangeNoPicture) {
  const scene::ScenePtr city = *scene::generateCity({1, 1'000, 100});
  const scene::Camera camera = cameraOf(*city, "tilted_city");
  for (const accel::BoxHits way : {accel::BoxHits::closest_hit, accel::BoxHits::any_hit}) {
    Stage all(city), few(city);
    render::CullingSettings settings;
    settings.lipac.box_hits = way;
    all.setCulling(Culling::lipac, settings);
    settings.lipac.counted_paths = 1'296;  // three quarters are traced where there are no boxes
    few.setCulling(Culling::lipac, settings);
    // Until hits have been weighed both hold what is in sight.
    const render::Frame a = all.tick(camera, small()), b = few.tick(camera, small());
    EXPECT_GT(a.stats.lipac->active, 20u);
    EXPECT_GT(a.stats.lipac->boxes, 20u);
    EXPECT_EQ(bytes(a), bytes(b));
    EXPECT_LT(a.stats.acceleration.tlas_bytes, b.stats.acceleration.tlas_bytes);
  }
}

/// A wide wall, 10 boxes behind the camera, 25 behind the wall, each group in cells of its own; a plain under all.
scene::ScenePtr wall(const scene::Material& material) {
  SceneBuilder builder;
  const uint32_t box = builder.prefab("box", cube(), builder.material(lambert({0.8f, 0.1f, 0.1f})));
  const uint32_t plain = builder.prefab("plain", quad(600.0f), builder.material(lambert(glm::vec3(0.4f))));
  const uint32_t screen = builder.prefab("screen", cube(), builder.material(material));
  builder.place(plain);
  builder.place(screen,
                glm::mat4x3(glm::vec3(30, 0, 0), glm::vec3(0, 24, 0), glm::vec3(0, 0, 0.2f), glm::vec3(0, 12, -24)));
  for (int i = 0; i < 10; ++i)
    builder.place(box, glm::mat4x3(glm::vec3(2, 0, 0), glm::vec3(0, 8, 0), glm::vec3(0, 0, 2),
                                   glm::vec3(3.0f * static_cast<float>(i % 5) - 6.0f, 4,
                                             40.0f + 4.0f * static_cast<float>(i / 5))));
  for (int i = 0; i < 25; ++i)
    builder.place(box, at({3.0f * static_cast<float>(i % 5) - 6.0f, 0.5f, -56.0f + 3.0f * static_cast<float>(i / 5)}));
  builder.environment().sky = {glm::vec3(1.0f), glm::vec3(0.3f)};
  return builder.build();
}

TEST(Lipac, AMirrorBringsWhatItShowsAndHidesWhatIsBehindIt) {
  const scene::ScenePtr scene = wall(metal(glm::vec3(0.95f), 0.0f));
  const scene::Camera camera = lookAt({0, 5, 12}, {0, 5, -24}, 0.35f);
  Stage full(scene), guided(scene);
  render::CullingSettings late;
  late.lipac.mitigation = false;  // what stands behind the mirror would be there for a guess
  guided.setCulling(Culling::lipac, late);
  const render::Frame early = guided.accumulate(camera, small(), 1);
  EXPECT_LE(early.stats.lipac->active, 12u);
  (void)guided.accumulate(camera, small(), 40);
  keepUp(full, camera, 41);
  const render::Frame a = still(full, camera, small()), b = still(guided, camera, small());
  showPicture(a, "lipac_mirror_full");
  showPicture(b, "lipac_mirror");
  EXPECT_EQ(b.stats.lipac->active, 12u);    // the plain, the mirror and what it shows
  EXPECT_EQ(b.stats.lipac->inactive, 25u);  // what stands behind it
  EXPECT_LT(difference(b, a), 0.02);
}

TEST(Lipac, WhatAnOccluderHidesStaysOut) {
  const scene::ScenePtr scene = wall(lambert(glm::vec3(0.6f)));
  const scene::Camera camera = lookAt({0, 5, 12}, {0, 5, -24}, 0.35f);
  Stage full(scene), guided(scene);
  guided.setCulling(Culling::lipac);
  // All of it is in the frustum or near it, so all of it appears; what is hidden has no hits, and leaves for good.
  EXPECT_EQ(guided.tick(camera, small()).stats.lipac->inactive, 0u);
  uint32_t cycles = 0;
  for (int tick = 1; tick < 40; ++tick) cycles += guided.tick(camera, small()).stats.lipac->cycles;
  EXPECT_EQ(cycles, 0u);
  keepUp(full, camera, 40);
  const render::Frame a = still(full, camera, small()), b = still(guided, camera, small());
  showPicture(b, "lipac_occluder");
  EXPECT_GE(b.stats.lipac->inactive, 25u);
  EXPECT_GE(b.stats.lipac->active, 2u);
  EXPECT_LT(difference(b, a), 0.02);
}

TEST(Lipac, WhatRaysDoNotMeetCastsItsShadowByTheMap) {
  SceneBuilder builder;
  const uint32_t plain = builder.prefab("plain", quad(600.0f), builder.material(lambert(glm::vec3(0.5f))));
  const uint32_t tower = builder.prefab("tower", cube(), builder.material(lambert(glm::vec3(0.5f))));
  builder.place(plain);
  for (int i = 0; i < 3; ++i)
    builder.place(tower, glm::mat4x3(glm::vec3(3, 0, 0), glm::vec3(0, 12, 0), glm::vec3(0, 0, 3),
                                     glm::vec3(8.0f * static_cast<float>(i) - 14.0f, 6, -4)));
  builder.environment().sky = {glm::vec3(0.2f), glm::vec3(0.2f)};
  builder.environment().sun.direction = {0.8f, -1.0f, 0.3f};
  builder.environment().sun.irradiance = glm::vec3(3.0f);
  const scene::ScenePtr scene = builder.build();
  const scene::Camera camera = lookAt({0, 14, 26}, {0, 0, -2}, 0.8f);
  render::ViewSettings settings = small();
  settings.bounces = 0;
  Stage full(scene), rays(scene), map(scene);
  rays.setCulling(Culling::none);
  map.setCulling(Culling::none);
  const render::Frame a = still(full, camera, settings), b = still(rays, camera, settings);
  settings.sun_shadow = render::SunShadow::rays_and_map;
  const render::Frame c = still(map, camera, settings);
  showPicture(a, "lipac_shadow_full");
  showPicture(b, "lipac_shadow_rays");
  showPicture(c, "lipac_shadow_map");
  EXPECT_EQ(c.stats.lipac->active, 1u);  // the plain alone
  // Where there is a shadow in truth and rays alone have none, the map has most of it: it is hard, and its texels are
  // coarse.
  uint32_t in_shadow = 0, lit_by_map = 0;
  for (uint32_t y = 0; y < settings.height; ++y)
    for (uint32_t x = 0; x < settings.width; ++x) {
      const float truth = texel(a, x, y).g, all_lit = texel(b, x, y).g;
      if (!(truth < 0.5f * all_lit)) continue;
      ++in_shadow;
      lit_by_map += texel(c, x, y).g > 0.6f * all_lit;  // towers that rays do not meet leave the sky's light in it
    }
  EXPECT_GT(in_shadow, settings.width * settings.height / 100);
  EXPECT_LT(10 * lit_by_map, in_shadow);
}

TEST(Lipac, RefusesThresholdsOutOfRange) {
  Stage stage(crowd(1));
  render::CullingSettings settings;
  settings.lipac.box_activate = -1.0f;
  const auto refused = renderer().setCulling(stage.handle(), Culling::lipac, settings);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().field, "culling.box_activate");
}

}  // namespace
}  // namespace helio::test
