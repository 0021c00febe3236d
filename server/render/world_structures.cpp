// What a tick builds of a world's acceleration structures, and what they take.
#include <algorithm>
#include <limits>

#include "render/camera_frame.h"
#include "render/world_renderer.h"

namespace helio::render {

void WorldRenderer::planStructures(const world::ChangeSet& changes, std::span<const ViewRequest> requests,
                                   std::span<const accel::Viewpoint> viewers, bool moved) {
  const std::vector<accel::WantedUnit> wanted = beginCulling(requests, viewers);
  const bool reference = std::any_of(viewers.begin(), viewers.end(), [](const auto& v) { return v.everything; });
  blas_batch_.begin(reference ? accel::BuildBudget::unlimited() : build_budget_);
  if (!guided_ && strategy_->volumes() == nullptr) {
    shared_blases_.planAll(changes.tick, commands_);
  } else {
    wantForNewcomers(changes);
    if (guided_) wantForSights();
    shared_blases_.plan(changes.tick, blas_batch_);
  }
  own_blases_.plan(wanted, units_, instances_, changes.tick, moved, blas_batch_);
  if (guided_) lipac_->serve(own_blases_, units_);
}

// Latency mitigation: what comes into sight is in the TLAS in the same tick, and so must its BLAS be. One of each kind
// in a block is looked at: where others have another level of detail, that one's stands in for theirs.
void WorldRenderer::wantForSights() {
  for (const shared::LipacSight& sight : lipac_->appearance().blocks())
    for (const uint32_t slot : instances_.kindsIn(sight.block & ~shared::kSightWhole))
      shared_blases_.want(shared_blases_.recordOf(instances_.records()[slot]));
}

// The GPU says one tick later what it needs; of what comes by an edit it is known at once.
void WorldRenderer::wantForNewcomers(const world::ChangeSet& changes) {
  for (const auto& [slot, instance] : changes.slots) {
    const accel::PlacedInstance& placed = instances_.instances()[slot];
    if (placed.prefab == scene::kNone || scene_->meshes[placed.mesh].deforms()) continue;
    const shared::InstanceRecord& record = instances_.records()[slot];
    if (guided_ ? accel::exceedsHitbox(record, scene_->meshes[placed.mesh].bounds)
                : strategy_->wants(placed.centre, placed.radius))
      shared_blases_.want(shared_blases_.recordOf(record));
  }
}

std::vector<accel::WantedUnit> WorldRenderer::wantedUnits(std::span<const accel::Viewpoint> viewers) const {
  std::vector<std::pair<float, uint32_t>> ranked;
  const std::vector<accel::Unit>& units = units_.units();
  for (uint32_t unit = 0; unit < units.size(); ++unit) {
    if (units[unit].slot == scene::kNone || !units_.deforms(unit)) continue;
    const accel::PlacedInstance& placed = instances_.instances()[units[unit].slot];
    if (!strategy_->wants(placed.centre, placed.radius)) continue;
    float nearest = std::numeric_limits<float>::max();
    for (const accel::Viewpoint& viewer : viewers)
      nearest = std::min(nearest, glm::distance(viewer.volume.position, placed.centre));
    ranked.emplace_back(nearest, unit);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<accel::WantedUnit> wanted;
  wanted.reserve(ranked.size());
  for (const auto& [distance, unit] : ranked)
    wanted.push_back({unit, detail_.levelFor(instances_, units[unit].slot, own_blases_.level(unit))});
  return wanted;
}

AccelerationUse WorldRenderer::accelerationUse(const View& view) const {
  const accel::OwnBlasFigures& own = own_blases_.figures();
  const accel::SharedBlasFigures& shared = shared_blases_.figures();
  AccelerationUse use;
  use.own_blases = own.in_tlas;
  use.own_blases_waiting = own.waiting;
  use.shared_blases = shared.resident;
  use.shared_blases_waiting = shared.waiting;
  use.shared_blases_built = shared.built;
  use.shared_blases_evicted = shared.evicted;
  use.blases_built = own.built + shared.built;
  use.blases_refitted = own.refitted;
  use.blas_triangles = own.triangles + shared.triangles;
  use.levels_switched = detail_.switched();
  const CameraFrame frame = cameraFrame(view.camera());
  const float aspect = static_cast<float>(view.settings().width) / static_cast<float>(view.settings().height);
  const shared::CullVolume frustum =
      accel::frustumOf(view.camera().position, frame.right, frame.up, frame.forward, frame.tangent, aspect);
  for (uint32_t unit = 0; unit < units_.units().size(); ++unit) {
    if (!own_blases_.inTlas(unit)) continue;
    const accel::PlacedInstance& placed = instances_.instances()[units_.units()[unit].slot];
    use.own_blases_in_view += accel::inFrustum(frustum, placed.centre, placed.radius);
  }
  use.shared_blas_bytes = shared_blases_.bytes();
  use.compaction_saved_bytes = shared_blases_.compactionSaved();
  use.own_blas_bytes = own_blases_.structureBytes();
  use.own_vertex_bytes = own_blases_.vertexBytes();
  use.tlas_bytes = tlas_.bytes();
  use.culling_bytes = lipac_ ? lipac_->bytes() : 0;
  use.scratch_bytes = tlas_.scratchBytes() + blas_batch_.scratchBytes();
  return use;
}

}  // namespace helio::render
