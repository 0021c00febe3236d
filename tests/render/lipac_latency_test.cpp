// Light path guided culling under cameras that jump, viewers that come, and budgets that are short.
#include <algorithm>
#include <cmath>

#include "scene/city.h"
#include "shared/lipac.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Culling;

constexpr uint32_t kUnits = 200;

scene::ScenePtr town() {
  static const scene::ScenePtr city = *scene::generateCity({1, 1'000, kUnits});
  return city;
}

const scene::Camera& cameraOf(const scene::Scene& scene, const std::string& name) {
  return std::find_if(scene.cameras.begin(), scene.cameras.end(), [&](const auto& c) { return c.name == name; })
      ->camera;
}

scene::Camera skyOver(scene::Camera camera) {
  camera.forward = {0.0f, 1.0f, 0.0f};
  camera.up = {0.0f, 0.0f, 1.0f};
  return camera;
}

render::ViewSettings small(uint32_t width = 96, uint32_t height = 54) {
  render::ViewSettings settings;
  settings.width = width;
  settings.height = height;
  settings.accumulate = settings.auto_exposure = false;
  settings.levels_of_detail = false;  // company brings finer ones, which is not what is compared
  return settings;
}

std::vector<render::CulledInstance> instances(render::WorldHandle world) {
  auto result = renderer().culledInstances(world);
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

/// The share of `settled`'s hits that belong to what `then` traced.
double carried(const std::vector<render::CulledInstance>& then, const std::vector<render::CulledInstance>& settled) {
  double held = 0.0, all = 0.0;
  for (size_t i = 0; i < settled.size(); ++i) {
    if (!settled[i].traced || settled[i].always) continue;
    all += settled[i].hits;
    if (then[i].traced) held += settled[i].hits;
  }
  return held / all;
}

/// Any number of views of one world.
class Company {
 public:
  Company(const scene::ScenePtr& scene, Culling culling, size_t views) : world_(scene) {
    handle_ = *renderer().addWorld(scene);
    if (!renderer().setCulling(handle_, culling)) throw std::runtime_error("no culling");
    for (size_t i = 0; i < views; ++i) views_.push_back(*renderer().addView(handle_));
  }
  ~Company() { renderer().removeWorld(handle_); }

  std::vector<render::Frame> tick(const std::vector<scene::Camera>& cameras, const render::ViewSettings& settings,
                                  double seconds) {
    std::vector<render::ViewRequest> requests;
    for (size_t i = 0; i < cameras.size(); ++i) requests.push_back({views_.at(i), cameras[i], settings});
    auto frames = renderer().tick(handle_, world_.beginTick(seconds), requests);
    if (!frames) throw std::runtime_error(frames.error().message);
    return std::move(*frames);
  }
  /// The mean of 32 samples of the first view, made anew, while time stands.
  render::Frame still(const std::vector<scene::Camera>& cameras) {
    renderer().removeView(views_.front());
    views_.front() = *renderer().addView(handle_);
    render::ViewSettings settings = small();
    settings.accumulate = settings.keep_radiance = true;
    settings.samples = 16;
    (void)tick(cameras, settings, 0.0);
    return std::move(tick(cameras, settings, 0.0).front());
  }
  render::WorldHandle handle() const { return handle_; }

 private:
  world::World world_;
  render::WorldHandle handle_ = 0;
  std::vector<render::ViewHandle> views_;
};

double meanDifference(const render::Frame& a, const render::Frame& b) {
  double sum = 0.0, whole = 0.0;
  for (size_t i = 0; i < b.radiance.size(); ++i) {
    sum += std::abs(static_cast<double>(a.radiance[i]) - static_cast<double>(b.radiance[i]));
    whole += static_cast<double>(b.radiance[i]);
  }
  return sum / whole;
}

TEST(LipacLatency, TheFirstFrameBehindAJumpHoldsWhatCarriesTheLight) {
  const scene::Camera target = cameraOf(*town(), "tilted_city");
  Stage mitigated(town()), late(town());
  render::CullingSettings off;
  off.lipac.mitigation = false;
  mitigated.setCulling(Culling::lipac);
  late.setCulling(Culling::lipac, off);
  double share[2][4];
  uint32_t shown = 0;
  for (const bool on : {true, false}) {
    Stage& stage = on ? mitigated : late;
    (void)stage.accumulate(skyOver(target), small(), 20);
    std::vector<std::vector<render::CulledInstance>> frames;
    for (int tick = 0; tick < 4; ++tick) {
      const render::Frame frame = stage.tick(target, small());
      frames.push_back(instances(stage.handle()));
      if (on) shown += frame.stats.lipac->shown;
      // Blocks, what deforms, commands and grants: never all instances.
      EXPECT_LE(frame.stats.lipac->cpu_visits, 3u * kUnits + town()->placements.size() / 64 + 1);
    }
    (void)stage.accumulate(target, small(), 36);
    const auto settled = instances(stage.handle());
    for (size_t tick = 0; tick < 4; ++tick) share[on][tick] = carried(frames[tick], settled);
  }
  EXPECT_GE(share[true][0], 0.8);  // what stands far beside the picture comes by its hits
  EXPECT_GE(share[true][3], 0.99);
  EXPECT_LT(share[false][0], 0.5 * share[true][0]);
  EXPECT_GT(shown, 10u);  // BLASes of their own came with the first frame too
}

TEST(LipacLatency, ABudgetOfBlocksIsKeptAndWorkedOff) {
  const scene::Camera target = cameraOf(*town(), "tilted_city");
  Stage all(town()), few(town());
  render::CullingSettings settings;
  all.setCulling(Culling::lipac, settings);
  settings.lipac.sight_blocks = 1;
  few.setCulling(Culling::lipac, settings);
  const uint32_t opened = all.tick(target, small()).stats.lipac->opened;
  uint32_t first = 0, sum = 0;
  for (int tick = 0; tick < 24; ++tick) {
    const uint32_t now = few.tick(target, small()).stats.lipac->opened;
    if (tick == 0) first = now;
    sum += now;
  }
  EXPECT_GT(first, 0u);
  EXPECT_LT(first, opened / 2);
  EXPECT_GT(sum, first);
}

TEST(LipacLatency, AStarvedBudgetHandsOverWithoutAGap) {
  const scene::Camera target = cameraOf(*town(), "animated_models");
  Stage stage(town());
  render::CullingSettings settings;
  settings.builds = 2;
  stage.setCulling(Culling::lipac, settings);
  (void)stage.accumulate(skyOver(target), small(), 20);
  uint32_t waited = 0, brought = 0;
  std::vector<render::CulledInstance> before = instances(stage.handle());
  for (int tick = 0; tick < 20; ++tick) {
    const render::Frame frame = stage.tick(target, small());
    const accel::LipacFigures& f = *frame.stats.lipac;
    EXPECT_LE(f.served + f.shown, 2u) << "tick " << tick;
    EXPECT_EQ(f.dropped, 0u) << "tick " << tick;
    waited += f.unshown + f.left_over > 0;
    brought += f.served + f.shown + frame.stats.acceleration.shared_blases_built;
    // Who is active is traced in the next tick, with its BLAS; who waits for one is not.
    auto now = instances(stage.handle());
    for (size_t slot = 0; slot < now.size(); ++slot) {
      if (before[slot].state == shared::kStateActive) { EXPECT_TRUE(now[slot].traced) << "slot " << slot; }
      if (now[slot].state == shared::kStateRequested) { EXPECT_FALSE(now[slot].traced) << "slot " << slot; }
    }
    before = std::move(now);
  }
  EXPECT_GT(waited, 5u);
  EXPECT_GT(brought, 20u);
}

TEST(LipacLatency, JumpsAndEditsReplayBitForBit) {
  const scene::Camera city = cameraOf(*town(), "tilted_city"), crowd = cameraOf(*town(), "animated_models");
  Stage first(town()), second(town());
  for (Stage* stage : {&first, &second}) stage->setCulling(Culling::lipac);
  for (int tick = 0; tick < 12; ++tick) {
    const scene::Camera camera = tick < 3 ? skyOver(city) : tick < 8 ? city : crowd;
    for (Stage* stage : {&first, &second})
      if (tick % 3 == 1) stage->edit({world::Destroy{{static_cast<uint64_t>(900 + tick)}}});
    const render::Frame a = first.tick(camera, small(64, 36)), b = second.tick(camera, small(64, 36));
    ASSERT_EQ(bytes(a), bytes(b)) << "tick " << tick;
    const accel::LipacFigures &x = *a.stats.lipac, &y = *b.stats.lipac;
    ASSERT_EQ(std::tie(x.inactive, x.omitted, x.requested, x.active, x.entries, x.served, x.shown, x.opened),
              std::tie(y.inactive, y.omitted, y.requested, y.active, y.entries, y.served, y.shown, y.opened))
        << "tick " << tick;
  }
}

TEST(LipacLatency, WhatIsBuiltInSightIsTracedAtOnce) {
  Stage stage(town());
  stage.setCulling(Culling::lipac);
  const scene::Camera camera = cameraOf(*town(), "city_at_sunset");
  (void)stage.accumulate(camera, small(), 30);
  const glm::vec3 place = camera.position + 25.0f * camera.forward;
  const uint64_t before = stage.world().instanceCount();
  stage.edit(
      {world::Build{town()->prefabs[town()->placements[500].prefab].name, {{place, glm::quat(1, 0, 0, 0), 1.0f}}}});
  ASSERT_EQ(stage.world().instanceCount(), before + 1);
  (void)stage.tick(camera, small());
  const auto now = instances(stage.handle());
  EXPECT_TRUE(now.back().traced);
}

TEST(LipacLatency, AFrozenWorldStaysAsItIs) {
  Stage stage(town());
  stage.setCulling(Culling::lipac);
  const render::Frame settled = stage.accumulate(cameraOf(*town(), "animated_models"), small(), 30);
  const auto states = [&] {
    std::vector<uint32_t> result;
    for (const render::CulledInstance& instance : instances(stage.handle())) result.push_back(instance.state);
    return result;
  };
  const auto before = states();
  ASSERT_TRUE(renderer().freezeCulling(stage.handle(), true).ok());
  const scene::Camera elsewhere = cameraOf(*town(), "tilted_city");
  for (int tick = 0; tick < 24; ++tick) {
    const render::Frame frame = stage.tick(elsewhere, small());
    EXPECT_EQ(frame.stats.lipac->changes + frame.stats.lipac->opened + frame.stats.lipac->box_hits, 0u) << tick;
    EXPECT_EQ(frame.stats.lipac->active, settled.stats.lipac->active) << tick;
  }
  EXPECT_EQ(states(), before);
  ASSERT_TRUE(renderer().freezeCulling(stage.handle(), false).ok());
  EXPECT_GT(stage.tick(elsewhere, small()).stats.lipac->opened, 0u);
  EXPECT_NE(states(), before);
  EXPECT_FALSE(renderer().freezeCulling(12345, true).ok());
}

TEST(LipacLatency, CompanyNeverMakesAViewersPictureWorse) {
  const scene::Camera mine = cameraOf(*town(), "tilted_city"), theirs = cameraOf(*town(), "animated_models");
  Company full(town(), Culling::full, 1), alone(town(), Culling::lipac, 1), together(town(), Culling::lipac, 3);
  scene::Camera beside = mine;
  beside.position.x += 4.0f;
  for (int tick = 0; tick < 30; ++tick) {
    (void)full.tick({mine}, small(16, 16), 1.0 / 60.0);
    (void)alone.tick({mine}, small(), 1.0 / 60.0);
    (void)together.tick({mine, theirs, beside}, small(), 1.0 / 60.0);
  }
  const auto by_one = instances(alone.handle()), by_three = instances(together.handle());
  uint32_t held = 0, lost = 0, gained = 0;
  for (size_t slot = 0; slot < by_one.size(); ++slot) {
    held += by_one[slot].traced;
    lost += by_one[slot].traced && !by_three[slot].traced;
    gained += !by_one[slot].traced && by_three[slot].traced;
  }
  EXPECT_LE(lost, held / 50);  // noise at the thresholds
  EXPECT_GT(gained, 0u);
  const render::Frame truth = full.still({mine}), one = alone.still({mine}),
                      three = together.still({mine, theirs, beside});
  showPicture(truth, "lipac_company_full");
  showPicture(one, "lipac_company_alone");
  showPicture(three, "lipac_company_three");
  EXPECT_LE(meanDifference(three, truth), 1.02 * meanDifference(one, truth) + 1e-3);
}

TEST(LipacLatency, WhatIsCulledCastsByTheMapWhereTheWorldSaysSo) {
  const scene::Camera camera = cameraOf(*town(), "tilted_city");
  Stage asked(town()), told(town());
  render::CullingSettings settings;
  asked.setCulling(Culling::lipac, settings);
  settings.cast_by_map = true;
  told.setCulling(Culling::lipac, settings);
  render::ViewSettings with_map = small();
  with_map.sun_shadow = render::SunShadow::rays_and_map;
  for (int tick = 0; tick < 2; ++tick) {
    const render::Frame a = asked.tick(camera, with_map), b = told.tick(camera, small());
    EXPECT_EQ(bytes(a), bytes(b)) << "tick " << tick;
    EXPECT_TRUE(recorded(b, "shadow_map"));
  }
}

TEST(LipacLatency, EveryViewOfItShowsItsColours) {
  using render::CullingView;
  const scene::Camera camera = cameraOf(*town(), "tilted_city");
  Stage guided(town()), none(town());
  guided.setCulling(Culling::lipac);
  none.setCulling(Culling::none);
  render::ViewSettings settings = small(160, 90);
  const auto shown = [&](Stage& stage, CullingView view, const char* name) {
    settings.culling_view = view;
    settings.keep_radiance = true;
    const render::Frame frame = stage.tick(camera, settings);
    showPicture(frame, name);
    return mean(frame);
  };
  (void)guided.accumulate(camera, small(), 30);
  (void)none.accumulate(camera, small(), 3);
  const glm::vec3 states = shown(guided, CullingView::states, "culling_states");
  EXPECT_GT(states.g, states.r);  // most of what is seen is active
  const glm::vec3 nothing = shown(none, CullingView::states, "culling_states_none");
  EXPECT_GT(nothing.b, 1.5f * states.b);
  const glm::vec3 traced = shown(guided, CullingView::untraced, "culling_untraced");
  const glm::vec3 untraced = shown(none, CullingView::untraced, "culling_untraced_none");
  EXPECT_GT(untraced.r - untraced.b, 2.0f * (traced.r - traced.b));
  const glm::vec3 boxes = shown(guided, CullingView::hitboxes, "culling_hitboxes");
  EXPECT_GT(boxes.g, shown(none, CullingView::hitboxes, "culling_hitboxes_none").g);
  const glm::vec3 rays = shown(guided, CullingView::rays, "culling_rays");
  EXPECT_GT(rays.r, 0.02f);
  EXPECT_GT(rays.g, 0.02f);
  const glm::vec3 above = shown(guided, CullingView::above, "culling_above");
  EXPECT_GT(above.r, 1.2f * shown(none, CullingView::above, "culling_above_none").r);
}

}  // namespace
}  // namespace helio::test
