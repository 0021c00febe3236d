// A scene that users change: instances, edits, sequence numbers, a clock. Knows no Vulkan and no gRPC.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "base/result.h"
#include "scene/scene.h"

namespace helio::world {

/// Stable for an instance's life, never used again. Base placements have ids 1..N in order; built ones follow.
using InstanceId = uint64_t;

/// Where users put things: position in metres, a unit quaternion, uniform scale in (0, 1000].
struct Pose {
  glm::vec3 position{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  float scale = 1.0f;

  glm::mat4x3 matrix() const;
};

// Edits, as users send them.
struct Build {
  std::string prefab;
  std::vector<Pose> poses;
};
struct Destroy {
  std::vector<InstanceId> ids;
};
/// Destroys what users may build, whose bounds' centre lies in the vertical cylinder.
struct DestroyRegion {
  glm::vec2 centre_xz{0.0f};
  float radius = 0.0f;
};
struct Move {
  InstanceId id = 0;
  Pose pose;
};
struct SetSun {
  scene::Sun sun;
  bool daylight = true;  ///< also set the sky that goes with the sun's elevation
};
/// Changes how world time runs; what is not given stays as it is, and something must be given.
struct SetTime {
  std::optional<bool> paused;
  std::optional<double> rate;  ///< seconds of world time a second, [0, 100]
  std::optional<double> seek;  ///< the new world time in seconds, [0, 1e9]
};
using Edit = std::variant<Build, Destroy, DestroyRegion, Move, SetSun, SetTime>;

/// World time and how it runs. What moves is a function of `time` and of the instance alone.
struct Clock {
  double time = 0.0;  ///< seconds, 0 or more
  double rate = 1.0;  ///< seconds of world time a second, while it is not paused
  bool paused = false;
};

// Resolved edits: what the log holds. Applying them needs no decision any more.
struct ResolvedBuild {
  uint32_t prefab = 0;
  InstanceId first_id = 0;
  std::vector<Pose> poses;
};
struct ResolvedDestroy {
  std::vector<InstanceId> ids;
};
struct ResolvedMove {
  InstanceId id = 0;
  Pose pose;
};
struct ResolvedEnvironment {
  scene::Environment environment;
};
/// The whole clock, as it is from this edit on.
struct ResolvedTime {
  Clock clock;
};
using ResolvedEdit = std::variant<ResolvedBuild, ResolvedDestroy, ResolvedMove, ResolvedEnvironment, ResolvedTime>;

struct Batch {
  std::vector<ResolvedEdit> edits;
  uint64_t tick = 0;  ///< the world's clock when it was resolved: replaying the batch sets the clock no earlier
  double time = 0.0;  ///< seconds: world time when it was resolved
};

/// The log's bytes of a batch (versioned, little-endian), and back. Errors: truncated, unknown kind (damaged), a newer
/// version (unsupported).
std::string encode(const Batch& batch);
Result<Batch> decode(std::span<const std::byte> bytes);

struct Limits {
  uint64_t max_instances = 1'000'000;
  uint32_t max_edits_per_batch = 10'000;
  uint32_t max_poses_per_batch = 100'000;
  uint32_t max_regions_per_batch = 64;  ///< each may have to look at every instance
  float max_coordinate = 100'000.0f;    ///< metres from the origin
};

/// A dense table entry. `prefab == scene::kNone`: the slot is free.
struct Instance {
  InstanceId id = 0;
  uint32_t prefab = scene::kNone;
  glm::mat4x3 transform{1.0f};
};

/// What changed between two ticks, as copies: readers need no lock. Slots appear once, in the order first touched.
struct ChangeSet {
  struct Slot {
    uint32_t slot;
    Instance instance;
  };
  uint64_t tick = 0;
  uint64_t applied_seq = 0;  ///< every edit up to here is in this change set or in an earlier one
  double time = 0.0;         ///< world time in seconds
  std::vector<Slot> slots;   ///< the first change set of a world holds all of its instances
  scene::Environment environment;
  bool environment_changed = true;
  uint32_t slot_count = 0;  ///< size of the table (slots are 0..slot_count-1)
};

struct Found {
  InstanceId id;
  uint32_t prefab;
  glm::mat4x3 transform;
};

/// A world at a sequence number, as bytes: what users made of the base scene, which is needed to read it again.
struct Saved {
  uint64_t seq = 0;
  std::string bytes;
};

class InstanceTable;

/// Thread-safe: one mutex guards everything, and no call gives out references into what it guards. Writers call
/// resolve() and then apply() under one logging lock of their own (service/): what was resolved must be applied next.
/// The tick thread calls beginTick(), which holds the mutex for as long as it takes to copy what changed.
class World {
 public:
  explicit World(scene::ScenePtr scene, Limits limits = {});
  ~World();

  const scene::Scene& scene() const { return *scene_; }
  const scene::ScenePtr& scenePtr() const { return scene_; }

  /// Checks a batch against the present state and assigns ids; changes nothing. All or none: the first bad edit's error
  /// names its index ("edits[3].destroy.ids[0]"). An id destroyed earlier in the same batch is unknown to later edits;
  /// an instance built earlier in the same batch can be reached by region, not by id (its id is not known to the sender
  /// yet). What users may not build (the terrain) they may neither move nor destroy: by id it is an error, by region it
  /// stays. Rotations and the sun's direction are normalised. Errors: invalid (a number, an empty list, what may not be
  /// built), not_found (a prefab, an id), limit (with the limit's value).
  Result<Batch> resolve(std::span<const Edit> edits) const;

  /// Applies a resolved batch under its sequence number (the last one plus 1), whole or not at all. Seen by the
  /// renderer from the next tick on. Limits are resolve()'s business: a log written under larger ones still replays.
  /// Errors: conflict (another sequence number, or ids that do not fit this state), invalid (numbers that resolve()
  /// never writes).
  Result<void> apply(uint64_t seq, const Batch& batch);

  /// Advances the clock by `seconds` at its rate, if it is not paused (less than 0 or not finite counts as 0), and
  /// hands out what changed since the last call. Costs what changed, not what exists; the first call hands out
  /// everything. `whole`: also becomes the change set that a world which has seen nothing yet needs to be as this one
  /// is in this tick; costs a look at every instance, under the mutex: some 20 ms a million.
  ChangeSet beginTick(double seconds, ChangeSet* whole = nullptr);

  /// Everything that edits and the clock made of the base scene. Costs a look at every instance, under the mutex: some
  /// 20 ms a million.
  Saved save() const;
  /// A world that was saved, into one of the same base scene that nothing has happened to yet; whole or not at all.
  /// Errors: something has happened to it (conflict), the bytes make no sense for this scene (damaged), a newer version
  /// (unsupported).
  Result<void> restore(const Saved& saved);

  /// Equal for worlds whose instances, light, next id, rate and pause (and time, while paused) are equal, and for no
  /// others but by chance (one in 2^64); the history, the running clock and the slots do not matter.
  uint64_t checksum() const;

  double time() const;  ///< the clock's time, seconds
  Clock clock() const;
  uint64_t seq() const;  ///< of the newest applied batch; 0 = none
  uint64_t instanceCount() const;
  std::vector<uint32_t> prefabCounts() const;  ///< live instances by prefab
  /// Instances whose bounds' centre lies in the cylinder, ascending by id, with ids greater than `after`, at most
  /// `limit`. Nothing lies in a cylinder that is not finite or has a negative radius.
  std::vector<Found> query(glm::vec2 centre_xz, float radius, InstanceId after, size_t limit) const;

 private:
  Result<void> checkApplicable(const Batch& batch) const;
  void commit(const ResolvedBuild& build);
  void commit(const ResolvedDestroy& destroy);
  void commit(const ResolvedMove& move);
  void commit(const ResolvedEnvironment& change);
  void commit(const ResolvedTime& change);

  const scene::ScenePtr scene_;
  const Limits limits_;
  std::unordered_map<std::string, uint32_t> prefab_by_name_;  // constant after construction

  mutable std::mutex mutex_;  // guards all below
  std::unique_ptr<InstanceTable> table_;
  scene::Environment environment_;
  bool environment_changed_ = true;
  InstanceId next_id_ = 1;
  uint64_t seq_ = 0;
  uint64_t tick_ = 0;
  Clock clock_;
};

}  // namespace helio::world
