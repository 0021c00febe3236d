#include "world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include <spdlog/fmt/fmt.h>

#include "world/instance_table.h"
#include "world/resolve.h"
#include "world/validate.h"

namespace helio::world {

glm::mat4x3 Pose::matrix() const {
  const glm::mat3 axes = glm::mat3_cast(rotation) * scale;
  return {axes[0], axes[1], axes[2], position};
}

World::World(scene::ScenePtr scene, Limits limits)
    : scene_(std::move(scene)),
      limits_(limits),
      table_(std::make_unique<InstanceTable>(*scene_)),
      environment_(scene_->environment) {
  for (uint32_t prefab = 0; prefab < scene_->prefabs.size(); ++prefab) {
    prefab_by_name_.emplace(scene_->prefabs[prefab].name, prefab);
  }
  for (const scene::Placement& placement : scene_->placements) {
    table_->insert(next_id_++, placement.prefab, placement.transform);
  }
}

World::~World() = default;

Result<Batch> World::resolve(std::span<const Edit> edits) const {
  const std::lock_guard lock(mutex_);
  auto batch = Resolver({*scene_, prefab_by_name_, limits_, *table_, environment_, clock_, next_id_}).resolve(edits);
  if (batch) {
    batch->tick = tick_;
    batch->time = clock_.time;
  }
  return batch;
}

Result<void> World::apply(uint64_t seq, const Batch& batch) {
  const std::lock_guard lock(mutex_);
  if (seq != seq_ + 1) {
    return Error{ErrorKind::conflict,
                 fmt::format("seq is {}: the next batch of this world is {}, apply batches in order", seq, seq_ + 1),
                 "seq", fmt::format("{}", seq), fmt::format("{}", seq_ + 1)};
  }
  if (Result<void> applicable = checkApplicable(batch); !applicable) return applicable;

  // The clock first: an edit of the batch may set it back.
  tick_ = std::max(tick_, batch.tick);
  if (std::isfinite(batch.time)) clock_.time = std::max(clock_.time, batch.time);
  for (const ResolvedEdit& edit : batch.edits) {
    std::visit([this](const auto& resolved) { commit(resolved); }, edit);
  }
  seq_ = seq;
  return {};
}

// Batches may come from a log's bytes, so nothing about them is taken for granted: what fails, fails before the first
// change.
Result<void> World::checkApplicable(const Batch& batch) const {
  InstanceId next_id = next_id_;
  std::unordered_set<InstanceId> destroyed;
  const auto isLive = [&](InstanceId id) {
    const bool built_here = id >= next_id_ && id < next_id;
    return (built_here || table_->find(id) != nullptr) && destroyed.count(id) == 0;
  };
  const auto unfit = [](const std::string& field, uint64_t value, const std::string& why) {
    return Error{
        ErrorKind::conflict, fmt::format("{} is {}: {}", field, value, why), field, fmt::format("{}", value), {}};
  };
  constexpr float kAnywhere = std::numeric_limits<float>::max();

  for (size_t i = 0; i < batch.edits.size(); ++i) {
    const std::string path = fmt::format("edits[{}]", i);
    if (const auto* build = std::get_if<ResolvedBuild>(&batch.edits[i])) {
      if (build->prefab >= scene_->prefabs.size()) {
        return unfit(path + ".prefab", build->prefab, fmt::format("the scene has {} prefabs", scene_->prefabs.size()));
      }
      if (build->first_id != next_id)
        return unfit(path + ".first_id", build->first_id, fmt::format("{} is next", next_id));
      for (size_t k = 0; k < build->poses.size(); ++k) {
        const Result<Pose> pose = checkedPose(build->poses[k], kAnywhere);
        if (!pose) return at(fmt::format("{}.poses[{}]", path, k), pose.error());
      }
      next_id += build->poses.size();
    } else if (const auto* destroy = std::get_if<ResolvedDestroy>(&batch.edits[i])) {
      for (size_t k = 0; k < destroy->ids.size(); ++k) {
        const InstanceId id = destroy->ids[k];
        if (!isLive(id)) return unfit(fmt::format("{}.ids[{}]", path, k), id, "there is no such instance");
        destroyed.insert(id);
      }
    } else if (const auto* move = std::get_if<ResolvedMove>(&batch.edits[i])) {
      if (!isLive(move->id)) return unfit(path + ".id", move->id, "there is no such instance");
      const Result<Pose> pose = checkedPose(move->pose, kAnywhere);
      if (!pose) return at(path + ".pose", pose.error());
    } else if (const auto* change = std::get_if<ResolvedEnvironment>(&batch.edits[i])) {
      const Result<scene::Sun> sun = checkedSun(change->environment.sun);
      if (!sun) return at(path + ".sun", sun.error());
      const scene::Sky& sky = change->environment.sky;
      for (const glm::vec3& radiance : {sky.zenith, sky.ground}) {
        if (std::isfinite(radiance.x + radiance.y + radiance.z) &&
            glm::all(glm::greaterThanEqual(radiance, glm::vec3(0))))
          continue;
        return at(path + ".sky", invalid("", "", "has a radiance that is negative or not finite"));
      }
    } else if (const auto* time = std::get_if<ResolvedTime>(&batch.edits[i])) {
      if (auto valid = checkClock(time->clock); !valid) return at(path, valid.error());
    }
  }
  return {};
}

void World::commit(const ResolvedBuild& build) {
  for (const Pose& pose : build.poses) table_->insert(next_id_++, build.prefab, pose.matrix());
}

void World::commit(const ResolvedDestroy& destroy) {
  for (InstanceId id : destroy.ids) table_->remove(id);
}

void World::commit(const ResolvedMove& move) { table_->move(move.id, move.pose.matrix()); }

void World::commit(const ResolvedEnvironment& change) {
  environment_ = change.environment;
  environment_changed_ = true;
}

void World::commit(const ResolvedTime& change) { clock_ = change.clock; }

ChangeSet World::beginTick(double seconds, ChangeSet* whole) {
  const std::lock_guard lock(mutex_);
  if (std::isfinite(seconds) && seconds > 0.0 && !clock_.paused) clock_.time += clock_.rate * seconds;

  ChangeSet changes;
  changes.tick = ++tick_;
  changes.applied_seq = seq_;
  changes.time = clock_.time;
  changes.slots = table_->takeDirty();
  changes.environment = environment_;
  changes.environment_changed = std::exchange(environment_changed_, false);
  changes.slot_count = table_->slotCount();
  if (whole) {
    *whole = changes;
    whole->environment_changed = true;
    whole->slots.clear();
    for (uint32_t slot = 0; slot < changes.slot_count; ++slot) whole->slots.push_back({slot, table_->at(slot)});
  }
  return changes;
}

double World::time() const { return clock().time; }

Clock World::clock() const {
  const std::lock_guard lock(mutex_);
  return clock_;
}

uint64_t World::seq() const {
  const std::lock_guard lock(mutex_);
  return seq_;
}

uint64_t World::instanceCount() const {
  const std::lock_guard lock(mutex_);
  return table_->liveCount();
}

std::vector<uint32_t> World::prefabCounts() const {
  const std::lock_guard lock(mutex_);
  return table_->prefabCounts();
}

std::vector<Found> World::query(glm::vec2 centre_xz, float radius, InstanceId after, size_t limit) const {
  if (!std::isfinite(centre_xz.x) || !std::isfinite(centre_xz.y) || !std::isfinite(radius) || radius < 0.0f) return {};
  const std::lock_guard lock(mutex_);

  std::vector<std::pair<InstanceId, uint32_t>> hits;  // id, slot
  table_->grid().visitDisc(centre_xz, radius, [&](uint32_t slot) {
    const InstanceId id = table_->at(slot).id;
    if (id > after) hits.emplace_back(id, slot);
  });
  const size_t wanted = std::min(limit, hits.size());
  std::partial_sort(hits.begin(), hits.begin() + static_cast<std::ptrdiff_t>(wanted), hits.end());

  std::vector<Found> found;
  found.reserve(wanted);
  for (size_t k = 0; k < wanted; ++k) {
    const Instance& instance = table_->at(hits[k].second);
    found.push_back({instance.id, instance.prefab, instance.transform});
  }
  return found;
}

}  // namespace helio::world
