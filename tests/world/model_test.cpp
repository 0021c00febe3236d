// Random edits on a world and on a naive model of it, which must agree; and the grid against plain search.
#include <algorithm>
#include <map>
#include <random>

#include "village.h"
#include "world/grid.h"

namespace helio::world {
namespace {

struct Thing {
  uint32_t prefab;
  glm::mat4x3 transform;
};

/// What the words of world.h mean, by searching through everything.
class NaiveWorld {
 public:
  explicit NaiveWorld(const scene::Scene& scene) : scene_(scene) {
    for (const auto& placement : scene.placements) things_[next_++] = {placement.prefab, placement.transform};
  }
  void build(uint32_t prefab, const std::vector<Pose>& poses) {
    for (const Pose& pose : poses) things_[next_++] = {prefab, pose.matrix()};
  }
  void destroy(InstanceId id) { things_.erase(id); }
  void move(InstanceId id, const Pose& pose) { things_.at(id).transform = pose.matrix(); }
  std::vector<InstanceId> in(glm::vec2 centre, float radius) const {
    std::vector<InstanceId> ids;
    for (const auto& [id, thing] : things_) {
      const auto& bounds = scene_.meshes[scene_.prefabs[thing.prefab].mesh].bounds;
      const glm::vec3 at = thing.transform * glm::vec4(bounds.centre(), 1);
      if (glm::distance(glm::dvec2(at.x, at.z), glm::dvec2(centre)) <= radius) ids.push_back(id);
    }
    return ids;
  }
  void destroyRegion(glm::vec2 centre, float radius) {
    for (InstanceId id : in(centre, radius)) {
      if (scene_.prefabs[things_.at(id).prefab].buildable) destroy(id);
    }
  }
  const std::map<InstanceId, Thing>& things() const { return things_; }

 private:
  const scene::Scene& scene_;
  std::map<InstanceId, Thing> things_;
  InstanceId next_ = 1;
};

TEST(Model, RandomEditsAgreeWithTheNaiveWorld) {
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const scene::ScenePtr scene = village();
    World world(scene);
    NaiveWorld model(*scene);
    std::map<uint32_t, Instance> seen;  // what a renderer would hold, by slot
    std::mt19937 random(seed);
    const auto real = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); };
    const auto below = [&](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random); };
    const auto randomPose = [&] {
      Pose pose = poseAt(real(-200, 200), real(-200, 200), real(0.1f, 4.0f));
      pose.rotation = glm::angleAxis(real(-3, 3), glm::normalize(glm::vec3(real(-1, 1), 1.0f, real(-1, 1))));
      return pose;
    };

    for (int step = 0; step < 200; ++step) {
      std::vector<Edit> edits;
      std::vector<InstanceId> changeable;  // known to the sender: live before this batch, not destroyed in it
      for (const auto& [id, thing] : model.things()) {
        if (thing.prefab != kTerrain) changeable.push_back(id);
      }
      for (size_t i = 1 + below(6); i > 0; --i) {
        const size_t choice = below(8);
        if (choice < 4) {
          std::vector<Pose> poses(1 + below(8));
          for (Pose& pose : poses) pose = randomPose();
          const uint32_t prefab = choice % 2 == 0 ? kHouse : kTree;
          edits.push_back(Build{scene->prefabs[prefab].name, poses});
          continue;
        }
        if (choice == 4) {
          edits.push_back(DestroyRegion{{real(-200, 200), real(-200, 200)}, real(1, 80)});
          changeable.clear();  // which of them are left, the sender cannot know
          continue;
        }
        if (changeable.empty()) continue;
        const size_t victim = below(changeable.size());
        if (choice == 5) {
          edits.push_back(Destroy{{changeable[victim]}});
          changeable.erase(changeable.begin() + static_cast<std::ptrdiff_t>(victim));
        } else {
          edits.push_back(Move{changeable[victim], randomPose()});
        }
      }
      if (edits.empty()) continue;

      const Batch batch = mustApply(world, edits);
      ASSERT_EQ(batch.edits.size(), edits.size());
      for (size_t i = 0; i < edits.size(); ++i) {
        if (const auto* build = std::get_if<ResolvedBuild>(&batch.edits[i])) model.build(build->prefab, build->poses);
        if (const auto* destroy = std::get_if<Destroy>(&edits[i])) model.destroy(destroy->ids[0]);
        if (const auto* region = std::get_if<DestroyRegion>(&edits[i]))
          model.destroyRegion(region->centre_xz, region->radius);
        if (const auto* move = std::get_if<ResolvedMove>(&batch.edits[i])) model.move(move->id, move->pose);
      }

      ASSERT_EQ(world.instanceCount(), model.things().size()) << "step " << step;
      const glm::vec2 centre{real(-250, 250), real(-250, 250)};
      const float radius = real(0, 300);
      ASSERT_EQ(idsIn(world, centre, radius), model.in(centre, radius)) << "step " << step;

      if (step % 3 != 0) continue;
      const ChangeSet changes = world.beginTick(0.1);
      for (const auto& slot : changes.slots) {
        ASSERT_LT(slot.slot, changes.slot_count);
        seen[slot.slot] = slot.instance;
      }
      size_t live = 0;
      for (const auto& [slot, instance] : seen) {
        if (instance.prefab == scene::kNone) continue;
        ++live;
        const auto thing = model.things().find(instance.id);
        ASSERT_NE(thing, model.things().end()) << "step " << step;
        EXPECT_EQ(instance.prefab, thing->second.prefab);
        EXPECT_EQ(instance.transform, thing->second.transform);
      }
      ASSERT_EQ(live, model.things().size()) << "step " << step;
    }
  }
}

TEST(HitboxGrid, FindsWhatPlainSearchFinds) {
  std::mt19937 random(7);
  const auto real = [&](float a, float b) { return std::uniform_real_distribution<float>(a, b)(random); };
  HitboxGrid grid;
  std::map<uint32_t, glm::vec2> points;
  for (uint32_t item = 0; item < 2000; ++item) {
    points[item] = {real(-300, 300), real(-300, 300)};
    grid.insert(item, points[item]);
  }
  for (uint32_t item = 0; item < 2000; item += 3) {
    grid.remove(item);
    points.erase(item);
  }
  for (uint32_t item = 0; item < 2000; item += 9) {
    points[item] = {real(0, 16), real(0, 16)};  // a crowd in one cell
    grid.insert(item, points[item]);
  }
  for (int round = 0; round < 200; ++round) {
    const glm::vec2 centre{real(-350, 350), real(-350, 350)};
    const float radius = round % 10 == 0 ? 1e9f : real(0, 200);
    std::vector<uint32_t> found, expected;
    grid.visitDisc(centre, radius, [&](uint32_t item) { found.push_back(item); });
    std::sort(found.begin(), found.end());
    for (const auto& [item, point] : points) {
      if (glm::distance(glm::dvec2(point), glm::dvec2(centre)) <= radius) expected.push_back(item);
    }
    ASSERT_EQ(found, expected);
  }
}

TEST(HitboxGrid, BearsPlacesBeyondAnyWorld) {
  HitboxGrid grid;
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<glm::vec2> places = {{1e30f, 0}, {-1e30f, 1e30f}, {inf, -inf}, {nan, 0}, {5, 5}};
  for (uint32_t item = 0; item < places.size(); ++item) grid.insert(item, places[item]);
  std::vector<uint32_t> found;
  grid.visitDisc({0, 0}, 10, [&](uint32_t item) { found.push_back(item); });
  EXPECT_THAT(found, ::testing::ElementsAre(4));
  found.clear();
  grid.visitDisc({1e30f, 0}, 1, [&](uint32_t item) { found.push_back(item); });
  EXPECT_THAT(found, ::testing::ElementsAre(0));
  for (uint32_t item = 0; item < places.size(); ++item) grid.remove(item);
  found.clear();
  grid.visitDisc({0, 0}, std::numeric_limits<float>::max(), [&](uint32_t item) { found.push_back(item); });
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace helio::world
