#include "render/passes/path_trace.h"

#include <algorithm>

#include "render/passes/shadow_map.h"
#include "render/passes/sunlight.h"
#include "shared/extra_samples.h"
#include "shared/paths.h"

static_assert(static_cast<uint32_t>(helio::render::SunShadow::rays_and_map) == helio::shared::kSunShadowRaysAndMap);
static_assert(static_cast<uint32_t>(helio::render::SunShadow::map) == helio::shared::kSunShadowMap);

static_assert(static_cast<uint32_t>(helio::render::IndirectRate::quarter) == helio::shared::kIndirectQuarter);

namespace helio::render {
namespace {
// Their ids in path_trace.rgen and lib/effects.glsl: ids below belong to the effects.
constexpr size_t kLogRaysConstant = 32, kMaterialsConstant = 40, kSkySamplingConstant = 41,
                 kMultipleScatteringConstant = 42, kManyLampsConstant = 43, kSunShadowConstant = 44,
                 kCountHitsConstant = 45, kSplitConstant = 46, kReshadesConstant = 48, kAnyHitBoxesConstant = 49,
                 kTechniqueConstant = 50, kAmbientConstant = 51, kLensConstant = 52, kLightFeedbackConstant = 53,
                 kIndirectRateConstant = 54, kHitDistancesConstant = 55, kSunApartConstant = 58,
                 kAmbientApartConstant = 59, kFurtherConstant = 57, kConstants = 60;

/// Below so many pixels a GPU is not filled anyway, and a launch less is worth more than dense launches.
constexpr uint64_t kSmallPicture = 300'000;
/// Roulette leaves so few paths beyond the second vertex that one launch takes them to their end.
constexpr uint32_t kLaunchesWithRoulette = 3;

/// Launches and the compaction between them take turns with path_info and the queue.
constexpr gpu::Use kPathUse{gpu::use::ray_write.stages | gpu::use::compute_write.stages, gpu::use::ray_write.access};
constexpr gpu::Use kQueueUse = PathQueue::kUse;

/// Groups of compact_paths.comp that cover the picture in tiles of 8 x 4 pixels.
uint32_t tileGroups(uint32_t width, uint32_t height) {
  const uint32_t pixels = gpu::alignUp(width, 8) * gpu::alignUp(height, 4);
  return (pixels + shared::kPathGroup - 1) / shared::kPathGroup;
}

}  // namespace

PathTrace::PathTrace(gpu::Device& device) : device_(device), compact_(device, "path_trace/compact_paths.comp") {}

gpu::RayTracingDescription describeTrace(const std::string& raygen, effects::EffectSet effects,
                                         const gpu::Specialisation& constants) {
  gpu::RayTracingDescription description{raygen,
                                         {"path_trace/surface.rmiss", "path_trace/shadow.rmiss"},
                                         {{"path_trace/surface.rchit", anyHit(effects)}},
                                         constants};
  // Only rays that count can meet boxes.
  if (constants.size() <= kCountHitsConstant || !constants[kCountHitsConstant]) return description;
  if (constants[kAnyHitBoxesConstant]) {
    description.misses.front() = "lipac/counted.rmiss";
    description.hits = {
        {"lipac/counted.rchit", anyHit(effects)}, {"", "lipac/cell.rahit"}, {"", "lipac/omitted.rahit"}};
  } else {
    description.hits.push_back({"lipac/cell.rchit", ""});
    description.hits.push_back({"lipac/omitted.rchit", ""});
  }
  return description;
}

std::string anyHit(effects::EffectSet effects) {
  return effects.has(effects::Effect::alpha_masks) ? "path_trace/cut_out.rahit" : "";
}

const gpu::RayTracingPipeline& PathTrace::variant(effects::EffectSet effects, const ViewSettings& settings, Paths paths,
                                                  bool count_hits, bool any_hit_boxes, bool light_feedback) {
  const bool log_rays = paths == Paths::logged;
  // What is shown takes emission's way.
  if (showsProperty(settings.materials)) effects.add(effects::Effect::emissive_triangles);
  gpu::Specialisation constants = effects::specialisation(effects);
  constants.resize(kConstants);
  constants[kLogRaysConstant] = log_rays;
  constants[kMaterialsConstant] = static_cast<uint32_t>(settings.materials);
  constants[kSkySamplingConstant] = settings.sky_sampling;
  constants[kMultipleScatteringConstant] = settings.multiple_scattering;
  constants[kManyLampsConstant] = settings.lamp_samples != 1;
  if (usesShadowMap(settings, effects)) constants[kSunShadowConstant] = static_cast<uint32_t>(settings.sun_shadow);
  constants[kCountHitsConstant] = count_hits;
  constants[kAnyHitBoxesConstant] = any_hit_boxes;
  constants[kSplitConstant] = splitsLight(settings) && !log_rays;
  constants[kTechniqueConstant] = static_cast<uint32_t>(settings.technique);
  constants[kAmbientConstant] = static_cast<uint32_t>(settings.ambient);
  constants[kLensConstant] = settings.aperture > 0.0f;
  constants[kLightFeedbackConstant] = light_feedback;
  constants[kIndirectRateConstant] = static_cast<uint32_t>(settings.indirect_rate);
  constants[kHitDistancesConstant] = settings.denoiser == Denoiser::reblur && !log_rays;
  constants[kSunApartConstant] = sunGoesApart(settings, effects) && !log_rays;
  constants[kAmbientApartConstant] =
      settings.denoiser != Denoiser::none && settings.ambient != Ambient::none && !log_rays;
  constants[kReshadesConstant] = settings.denoiser == Denoiser::asvgf && paths == Paths::first;
  constants[kFurtherConstant] = paths == Paths::further;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = variants_.find(constants); found != variants_.end()) return found->second;
  }
  // Compile without the lock, so that no other world waits; should two do it at once, the first stays.
  gpu::RayTracingPipeline pipeline(device_, describeTrace("path_trace/path_trace.rgen", effects, constants));
  const std::lock_guard lock(mutex_);
  return variants_.emplace(constants, std::move(pipeline)).first->second;
}

void PathTrace::record(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, const View& view,
                       const PathQueue& paths, shared::SampleConstants sample) const {
  const ViewSettings& settings = view.settings();
  const uint32_t launches = this->launches(settings), last_vertex = vertices(settings.bounces) - 1;
  if (launches > 1) {
    paths.clear(commands);
    commands.barrier(gpu::use::transfer_write, kQueueUse);
  }
  for (uint32_t launch = 0;; ++launch) {
    const bool last = launch + 1 == launches;
    sample.launch = sample.first_vertex = launch;
    sample.last_vertex = last ? last_vertex : launch;
    commands.bind(pipeline);
    commands.push(sample);
    if (launch == 0 && sample.listed) paths.traceRound(commands, pipeline, sample.tick_sample);
    else if (launch == 0) commands.traceRays(pipeline, settings.width, settings.height);
    else paths.trace(commands, pipeline, launch);
    if (last) return;

    commands.barrier(gpu::use::ray_write, gpu::use::compute_write);
    commands.bind(compact_);
    commands.push(sample);
    if (launch == 0 && sample.listed) paths.dispatchRound(commands, sample.tick_sample);
    else if (launch == 0) commands.dispatch(tileGroups(settings.width, settings.height));
    else paths.dispatch(commands, launch);
    commands.barrier(gpu::use::compute_write, kQueueUse);
  }
}

uint32_t PathTrace::launches(const ViewSettings& settings) const {
  const uint32_t all = vertices(settings.bounces);
  if (settings.path_launches > 0) return std::min(all, settings.path_launches);
  if (!device_.cpu() && uint64_t{settings.width} * settings.height < kSmallPicture) return 1;
  return settings.roulette ? std::min(all, kLaunchesWithRoulette) : all;
}

void PathTrace::add(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) {
  View& view = pass.view;
  const gpu::RayTracingPipeline& pipeline = variant(effects, view.settings(), Paths::first, pass.hits != nullptr,
                                                    pass.any_hit_boxes, pass.light_lists != nullptr);
  pass.graph.add("path_trace", pass.owner, accesses(pass),
                 [this, &pipeline, &view, &paths = pass.paths, sample](gpu::Commands& commands) {
                   record(commands, pipeline, view, paths, sample);
                 });
}

void PathTrace::addExtra(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects,
                         const Statistics& statistics) {
  View& view = pass.view;
  const gpu::RayTracingPipeline& pipeline = variant(effects, view.settings(), Paths::further, false, false,
                                                    pass.light_lists != nullptr);  // they do not count
  pass.graph.add("extra_paths", pass.owner, accesses(pass),
                 [this, &pipeline, &view, &paths = pass.paths, &statistics, sample](gpu::Commands& commands) {
                   shared::SampleConstants further = sample;
                   further.listed = 1;
                   for (uint32_t round = 1; round <= shared::kMostExtraPaths; ++round) {
                     further.tick_sample = round;
                     if (round > 1) commands.barrier(kQueueUse, kQueueUse);
                     record(commands, pipeline, view, paths, further);
                     commands.barrier(gpu::use::ray_write, gpu::use::compute_write);
                     statistics.recordRound(commands, paths, further);
                   }
                 });
}

std::vector<Access> PathTrace::accesses(const ViewPass& pass) {
  View& view = pass.view;
  std::vector<Access> accesses{{pass.tlas, gpu::use::trace},
                               {pass.instances, gpu::use::ray_read},
                               {&view.constants, gpu::use::ray_read},
                               {&view.visibility, gpu::use::ray_read},
                               {&view.shadow_image, gpu::use::ray_read},
                               {&pass.paths, kQueueUse},
                               {&view.radiance, gpu::use::ray_write},
                               {&view.path_info, kPathUse},
                               // Light by lobe, and the surfaces that belong to it.
                               {&view.histories.sampled, gpu::use::ray_write},
                               {&view.histories.spare, gpu::use::ray_write},
                               {&view.histories.sunlight(), gpu::use::ray_write},
                               {&view.histories.occlusion, gpu::use::ray_write},
                               {&view.histories.surface(), gpu::use::ray_write},
                               {&view.histories.claims, gpu::use::ray_read},
                               {&view.histories.indirect, gpu::use::ray_write},
                               {&view.state, gpu::use::ray_write}};
  if (pass.light_lists) accesses.push_back({pass.light_lists, gpu::use::ray_write});
  if (pass.hits) accesses.push_back({pass.hits, gpu::use::ray_write});
  return accesses;
}

void PathTrace::addLog(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) {
  View& view = pass.view;
  const gpu::RayTracingPipeline& pipeline = variant(effects, view.settings(), Paths::logged, false, false, false);
  pass.graph.add("log_rays", pass.owner,
                 {{pass.tlas, gpu::use::trace},
                  {pass.instances, gpu::use::ray_read},
                  {&view.constants, gpu::use::ray_read},
                  {&view.visibility, gpu::use::ray_read},
                  {&pass.paths, kQueueUse},
                  {&view.radiance, gpu::use::ray_write},
                  {&view.path_info, kPathUse},
                  {&view.ray_log, gpu::use::ray_write}},
                 [this, &pipeline, &view, &paths = pass.paths, sample](gpu::Commands& commands) {
                   record(commands, pipeline, view, paths, sample);
                 });
}

}  // namespace helio::render
