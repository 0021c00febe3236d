// A world as bytes. The base scene is not in them: it is known by the manifest, and most of it is as it was.
// Little-endian:
//
//   u8 version (2), u64 seq, u64 tick, clock, u64 instances of the base scene, u64 next id, environment,
//   u32 destroyed, u64 id each           of the base scene
//   u32 placed, then each                what was built, and what was moved
//     u64 id, u32 prefab, f32 transform  columns x, y, z axes and translation
//   clock: f64 time, f64 rate, u8 paused (version 1: the time alone)
#include <algorithm>
#include <cmath>
#include <unordered_set>

#include <spdlog/fmt/fmt.h>

#include "world/bytes.h"
#include "world/checksum.h"
#include "world/instance_table.h"
#include "world/validate.h"
#include "world/world.h"

namespace helio::world {
namespace {

constexpr uint8_t kVersion = 2;
constexpr size_t kInstanceBytes = sizeof(InstanceId) + sizeof(uint32_t) + kTransformBytes;

struct Contents {
  uint64_t seq = 0, tick = 0;
  Clock clock;
  uint64_t base_instances = 0;
  InstanceId next_id = 0;
  scene::Environment environment;
  std::vector<InstanceId> destroyed;
  std::vector<Instance> placed;
};

Error damaged(const std::string& why) {
  return {ErrorKind::damaged, "snapshot: " + why + ", the log is damaged", "snapshot", {}, {}};
}

std::string encode(const Contents& contents) {
  Writer out;
  out.integer(kVersion);
  out.integer(contents.seq);
  out.integer(contents.tick);
  out.clock(contents.clock);
  out.integer(contents.base_instances);
  out.integer(contents.next_id);
  out.environment(contents.environment);
  out.integer(static_cast<uint32_t>(contents.destroyed.size()));
  for (const InstanceId id : contents.destroyed) out.integer(id);
  out.integer(static_cast<uint32_t>(contents.placed.size()));
  out.reserve(contents.placed.size() * kInstanceBytes);
  for (const Instance& instance : contents.placed) {
    out.integer(instance.id);
    out.integer(instance.prefab);
    out.transform(instance.transform);
  }
  return out.take();
}

Result<Contents> decode(const std::string& bytes) {
  Reader in(std::as_bytes(std::span(bytes)));
  const uint8_t version = in.integer<uint8_t>();
  if (version > kVersion)
    return Error{ErrorKind::unsupported,
                 fmt::format("snapshot: version {}, this server knows versions up to {}: start the newer one", version,
                             kVersion),
                 "snapshot", fmt::format("{}", version), fmt::format("{}", kVersion)};
  if (in.failed() || version == 0) return damaged("it has no version");
  Contents contents;
  contents.seq = in.integer<uint64_t>();
  contents.tick = in.integer<uint64_t>();
  if (version == 1) contents.clock.time = in.realDouble();
  else contents.clock = in.clock();
  contents.base_instances = in.integer<uint64_t>();
  contents.next_id = in.integer<InstanceId>();
  contents.environment = in.environment();
  contents.destroyed.resize(in.count(sizeof(InstanceId)));
  for (InstanceId& id : contents.destroyed) id = in.integer<InstanceId>();
  contents.placed.resize(in.count(kInstanceBytes));
  for (Instance& instance : contents.placed) {
    instance.id = in.integer<InstanceId>();
    instance.prefab = in.integer<uint32_t>();
    instance.transform = in.transform();
  }
  if (in.failed()) return damaged("truncated");
  if (in.remaining() != 0) return damaged(fmt::format("{} bytes too many", in.remaining()));
  return contents;
}

bool isFinite(const glm::mat4x3& m) {
  float sum = 0.0f;
  for (int column = 0; column < 4; ++column) sum += m[column].x + m[column].y + m[column].z;
  return std::isfinite(sum);
}

/// Whether it can be laid over this scene.
Result<void> check(const Contents& contents, const scene::Scene& scene) {
  const uint64_t base = scene.placements.size();
  if (contents.base_instances != base)
    return damaged(
        fmt::format("it was made of a scene of {} instances, this one has {}", contents.base_instances, base));
  if (const auto clock = checkClock(contents.clock); !clock) return damaged("its clock: " + clock.error().message);
  if (const auto sun = checkedSun(contents.environment.sun); !sun) return damaged("its sun: " + sun.error().message);

  std::unordered_set<InstanceId> named;
  for (const InstanceId id : contents.destroyed)
    if (id == 0 || id > base || !named.insert(id).second) return damaged(fmt::format("it destroys instance {}", id));
  for (const Instance& instance : contents.placed) {
    const auto& [id, prefab, transform] = instance;
    const bool known = id != 0 && id < contents.next_id && named.insert(id).second;
    const bool fits = prefab < scene.prefabs.size() && (id > base || prefab == scene.placements[id - 1].prefab);
    if (!known || !fits || !isFinite(transform)) return damaged(fmt::format("it places instance {}", id));
  }
  if (contents.next_id <= base) return damaged(fmt::format("its next id is {}", contents.next_id));
  return {};
}

}  // namespace

Saved World::save() const {
  const std::lock_guard lock(mutex_);
  Contents contents;
  contents.seq = seq_;
  contents.tick = tick_;
  contents.clock = clock_;
  contents.base_instances = scene_->placements.size();
  contents.next_id = next_id_;
  contents.environment = environment_;

  const uint64_t base = scene_->placements.size();
  for (InstanceId id = 1; id <= base; ++id)
    if (table_->find(id) == nullptr) contents.destroyed.push_back(id);
  for (uint32_t slot = 0; slot < table_->slotCount(); ++slot) {
    const Instance& instance = table_->at(slot);
    if (instance.prefab == scene::kNone) continue;
    const bool as_placed = instance.id <= base && instance.transform == scene_->placements[instance.id - 1].transform;
    if (!as_placed) contents.placed.push_back(instance);
  }
  std::sort(contents.placed.begin(), contents.placed.end(), [](auto& a, auto& b) { return a.id < b.id; });
  return {seq_, encode(contents)};
}

Result<void> World::restore(const Saved& saved) {
  const auto contents = decode(saved.bytes);
  if (!contents) return contents.error();
  if (auto fits = check(*contents, *scene_); !fits) return fits;
  if (contents->seq != saved.seq) return damaged(fmt::format("it is of seq {}, not of {}", contents->seq, saved.seq));

  const std::lock_guard lock(mutex_);
  if (seq_ != 0 || tick_ != 0)
    return Error{ErrorKind::conflict, "something has happened to this world already: restore into a new one", "seq",
                 fmt::format("{}", seq_), "0"};
  for (const InstanceId id : contents->destroyed) table_->remove(id);
  for (const Instance& instance : contents->placed) {
    if (instance.id <= contents->base_instances) table_->move(instance.id, instance.transform);
    else table_->insert(instance.id, instance.prefab, instance.transform);
  }
  environment_ = contents->environment;
  environment_changed_ = true;
  next_id_ = contents->next_id;
  seq_ = contents->seq;
  tick_ = contents->tick;
  clock_ = contents->clock;
  return {};
}

uint64_t World::checksum() const {
  const std::lock_guard lock(mutex_);
  return Hash().add(table_->checksum()).add(hashOf(environment_)).add(hashOf(clock_)).add(next_id_).value();
}

}  // namespace helio::world
