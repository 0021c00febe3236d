// From what users send to what the log holds: checks, assigned ids, regions turned into lists.
#pragma once

#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "world/instance_table.h"
#include "world/world.h"

namespace helio::world {

/// The state that a batch is resolved against.
struct Present {
  const scene::Scene& scene;
  const std::unordered_map<std::string, uint32_t>& prefab_by_name;
  const Limits& limits;
  const InstanceTable& table;
  scene::Environment environment;
  Clock clock;
  InstanceId next_id;
};

/// Resolves one batch. The table stays as it is: what earlier edits of the batch did is kept as an overlay on it.
class Resolver {
 public:
  explicit Resolver(Present present);

  Result<Batch> resolve(std::span<const Edit> edits);

 private:
  Result<ResolvedEdit> resolveEdit(const Build& build, const std::string& path);
  Result<ResolvedEdit> resolveEdit(const Destroy& destroy, const std::string& path);
  Result<ResolvedEdit> resolveEdit(const DestroyRegion& region, const std::string& path);
  Result<ResolvedEdit> resolveEdit(const Move& move, const std::string& path);
  Result<ResolvedEdit> resolveEdit(const SetSun& set, const std::string& path);
  Result<ResolvedEdit> resolveEdit(const SetTime& set, const std::string& path);

  /// The instance of an id that users may change, as it was before the batch. Errors: not_found, invalid.
  Result<const Instance*> changeable(InstanceId id, const std::string& field) const;
  void overlay(InstanceId id, glm::vec2 xz);
  void destroy(InstanceId id);

  Present present_;
  uint64_t live_;
  size_t poses_ = 0;
  size_t regions_ = 0;
  std::unordered_set<InstanceId> destroyed_;
  HitboxGrid overlay_grid_;                              // where what was built or moved in this batch is now
  std::vector<InstanceId> overlay_ids_;                  // by item of overlay_grid_
  std::unordered_map<InstanceId, uint32_t> overlay_of_;  // the item of an id
};

}  // namespace helio::world
