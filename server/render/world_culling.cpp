// Which instances of a world rays can meet: the strategy, and light path guided culling around a tick.
#include <algorithm>
#include <cstring>

#include "render/world_renderer.h"

namespace helio::render {
namespace {

/// Of a tick.
uint64_t pathsOf(const ViewSettings& settings) { return uint64_t{settings.width} * settings.height * settings.samples; }

}  // namespace

void WorldRenderer::setCulling(Culling culling, const CullingSettings& settings) {
  const std::lock_guard lock(mutex_);
  reassemble_ = true;
  lipac_.reset();
  cast_by_map_ = frozen_ = false;
  build_budget_ = {settings.builds, settings.build_triangles};
  shared_blases_.set(settings.shared_blases);
  strategy_ = culling == Culling::frustum_radius ? accel::frustumRadiusStrategy(settings.radius)
              : culling == Culling::distance     ? accel::distanceStrategy(settings.radius)
                                                 : accel::fullStrategy();
  if (culling != Culling::lipac && culling != Culling::none) return;
  accel::LipacSettings lipac = settings.lipac;
  if (culling == Culling::none) lipac.box_activate = accel::LipacSettings::kUnreachable;
  lipac_ = std::make_unique<accel::Lipac>(*device_, commands_, *scene_, lipac);
  cast_by_map_ = settings.cast_by_map;
  if (!instances_.order().empty()) return;  // too late: who looks already waits for the compiler
  guided_ = true;
  warmUp();
  lipac_->forget();
}

void WorldRenderer::freezeCulling(bool frozen) {
  const std::lock_guard lock(mutex_);
  frozen_ = frozen;
}

std::vector<ViewRequest> WorldRenderer::castByMap(std::span<const ViewRequest> requests) const {
  std::vector<ViewRequest> result(requests.begin(), requests.end());
  if (lipac_ && cast_by_map_)
    for (ViewRequest& request : result)
      if (request.settings.mode == Mode::hybrid && request.settings.sun_shadow == SunShadow::rays)
        request.settings.sun_shadow = SunShadow::rays_and_map;
  return result;
}

std::vector<accel::WantedUnit> WorldRenderer::beginCulling(std::span<const ViewRequest> requests,
                                                           std::span<const accel::Viewpoint> viewers) {
  guided_ = lipac_ && std::none_of(viewers.begin(), viewers.end(), [](const auto& v) { return v.everything; });
  if (!guided_) return wantedUnits(viewers);
  all_count_ = std::all_of(requests.begin(), requests.end(),
                           [this](const ViewRequest& request) { return strideOf(request.settings) == 1; });
  std::vector<accel::WantedUnit> wanted;
  std::vector<accel::Sight> sights;
  for (size_t i = 0; i < requests.size() && !frozen_; ++i) sights.push_back({requests[i].view, viewers[i].volume});
  for (const uint32_t unit : lipac_->begin(sights, instances_, units_))
    wanted.push_back({unit, detail_.levelFor(instances_, units_.units()[unit].slot, own_blases_.level(unit))});
  return wanted;
}

Result<std::vector<CulledInstance>> WorldRenderer::culledInstances() {
  const std::lock_guard lock(mutex_);
  if (!lipac_ || !lipac_->words())
    return Error{ErrorKind::unsupported,
                 "no light path guided culling in this world, or no tick yet: set it with setCulling() and tick",
                 "culling",
                 {},
                 {}};
  const gpu::Buffer* tables[] = {&lipac_->words(), &lipac_->untraced(), &lipac_->entries()};
  std::vector<uint32_t> read[3];
  for (size_t i = 0; i < 3; ++i) {
    gpu::Buffer back(*device_, {"states of instances, read back", tables[i]->size(), gpu::MemoryCategory::transfer,
                                gpu::Placement::readback});
    commands_.begin();
    commands_.copy(*tables[i], back, tables[i]->size());
    commands_.barrier(gpu::use::transfer_write, gpu::use::host_read);
    commands_.submit();
    (void)commands_.finish();
    back.invalidate();
    read[i].resize(tables[i]->size() / sizeof(uint32_t));
    std::memcpy(read[i].data(), back.mapped(), tables[i]->size());
  }
  const auto& [words, untraced, entries] = read;
  std::vector<CulledInstance> instances(instances_.records().size());
  for (size_t i = 0; i < instances_.order().size(); ++i) {
    const uint32_t slot = instances_.order()[i];
    instances[slot].state = words[slot] & 3u;
    instances[slot].traced = untraced[slot] == 0;
    instances[slot].always = (entries[i] & shared::kNoCell) == shared::kNoCell;
    instances[slot].hits = static_cast<double>(words[slot] >> shared::kSmoothedShift) / shared::kHitUnit;
  }
  return instances;
}

void WorldRenderer::uploadCulling(gpu::Commands& commands) {
  const auto count = static_cast<uint32_t>(instances_.order().size());
  tlas_.reserve(commands, lipac_->wantedRoom(count, all_count_));
  lipac_->upload(commands,
                 {instances_.orderBuffer().address(), instances_.recordBuffer().address(), shared_blases_.table(),
                  shared_blases_.needs(), count, static_cast<uint32_t>(instances_.records().size()), rests_},
                 static_cast<uint32_t>(units_.units().size()));
}

void WorldRenderer::addFeedback(Graph& graph, uint64_t tick) {
  graph.add("feedback", Graph::kShared,
            {{&lipac_, gpu::use::compute_write}, {&shared_blases_, gpu::use::compute_write}},
            [this, counted = !frozen_ && quorum_.complete(tick)](gpu::Commands& commands) {
              lipac_->feedback(commands, counted);
              shared_blases_.readBack(commands);
            });
}

uint32_t WorldRenderer::strideOf(const ViewSettings& settings) const {
  const uint64_t most = lipac_->settings().counted_paths;
  return static_cast<uint32_t>((pathsOf(settings) + most - 1) / most);
}

void WorldRenderer::describeCounting(shared::FrameConstants& constants, const View& view) const {
  constants.instance_hits = lipac_->hits().address();
  constants.hitboxes = lipac_->hitboxes().address();
  constants.culling = lipac_->tickConstants();
  constants.counted_tlas = tlas_.countedAddress();
  constants.hit_stride = 1;
  if (!view.counts_hits) return;
  constants.hit_stride = strideOf(view.settings());
  constants.hit_turn = lipac_->ticks() % constants.hit_stride;
  const uint64_t all = uint64_t{shared::kHitUnit} * shared::kReferencePaths * constants.hit_stride;
  const uint64_t paths = pathsOf(view.settings());
  constants.hit_weight = static_cast<uint32_t>((all + paths / 2) / paths);
}

}  // namespace helio::render
