// Which instances of a world rays can meet: the strategy, and light path guided culling around a tick.
#include <algorithm>

#include "render/world_renderer.h"

namespace helio::render {

void WorldRenderer::setCulling(Culling culling, const CullingSettings& settings) {
  const std::lock_guard lock(mutex_);
  reassemble_ = true;
  lipac_.reset();
  own_blases_.setBudget({settings.builds, settings.build_triangles});
  strategy_ = culling == Culling::frustum_radius ? accel::frustumRadiusStrategy(settings.radius)
              : culling == Culling::distance     ? accel::distanceStrategy(settings.radius)
                                                 : accel::fullStrategy();
  if (culling != Culling::lipac && culling != Culling::none) return;
  accel::LipacSettings lipac = settings.lipac;
  if (culling == Culling::none) lipac.box_activate = accel::LipacSettings::kUnreachable;
  lipac_ = std::make_unique<accel::Lipac>(*device_, commands_, *scene_, lipac);
}

std::vector<accel::WantedUnit> WorldRenderer::beginCulling(std::span<const accel::Viewpoint> viewers) {
  guided_ = lipac_ && std::none_of(viewers.begin(), viewers.end(), [](const auto& v) { return v.everything; });
  if (!guided_) return wantedUnits(viewers);
  std::vector<accel::WantedUnit> wanted;
  for (const uint32_t unit : lipac_->begin(units_))
    wanted.push_back({unit, detail_.levelFor(instances_, units_.units()[unit].slot, own_blases_.level(unit))});
  return wanted;
}

void WorldRenderer::uploadCulling(gpu::Commands& commands) {
  const auto count = static_cast<uint32_t>(instances_.order().size());
  tlas_.reserve(commands, lipac_->wantedEntries(count));
  lipac_->upload(commands,
                 {instances_.orderBuffer().address(), instances_.recordBuffer().address(), resources_.meshes(), count,
                  static_cast<uint32_t>(instances_.records().size())},
                 static_cast<uint32_t>(units_.units().size()));
}

void WorldRenderer::addFeedback(Graph& graph, uint64_t tick) {
  graph.add("feedback", Graph::kShared, {{&lipac_, gpu::use::compute_write}},
            [this, counted = quorum_.complete(tick)](gpu::Commands& commands) { lipac_->feedback(commands, counted); });
}

void WorldRenderer::describeCounting(shared::FrameConstants& constants, const View& view) const {
  constants.instance_hits = lipac_->hits().address();
  constants.hitboxes = lipac_->hitboxes().address();
  constants.hit_stride = 1;
  if (!view.counts_hits) return;
  const ViewSettings& settings = view.settings();
  const uint64_t paths = uint64_t{settings.width} * settings.height * settings.samples;
  constants.hit_stride = static_cast<uint32_t>((paths + shared::kReferencePaths - 1) / shared::kReferencePaths);
  const uint64_t all = uint64_t{shared::kHitUnit} * shared::kReferencePaths * constants.hit_stride;
  constants.hit_weight = static_cast<uint32_t>((all + paths / 2) / paths);
}

}  // namespace helio::render
