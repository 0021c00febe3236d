#include "render/passes/path_trace.h"

namespace helio::render {
namespace {
constexpr size_t kLogRaysConstant = 32;  // its id in path_trace.rgen: ids below belong to the effects
}

gpu::RayTracingDescription describeTrace(const std::string& raygen, const gpu::Specialisation& constants) {
  return {
      raygen, {"path_trace/surface.rmiss", "path_trace/shadow.rmiss"}, {{"path_trace/surface.rchit", ""}}, constants};
}

const gpu::RayTracingPipeline& PathTrace::variant(effects::EffectSet effects, bool log_rays) {
  const std::pair key{effects.bits, log_rays};
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = variants_.find(key); found != variants_.end()) return found->second;
  }
  // Compile without the lock, so that no other world waits; should two do it at once, the first stays.
  gpu::Specialisation constants = effects::specialisation(effects);
  constants.resize(kLogRaysConstant + 1);
  constants[kLogRaysConstant] = log_rays;
  gpu::RayTracingPipeline pipeline(device_, describeTrace("path_trace/path_trace.rgen", constants));
  const std::lock_guard lock(mutex_);
  return variants_.emplace(key, std::move(pipeline)).first->second;
}

void PathTrace::add(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) {
  View& view = pass.view;
  const gpu::RayTracingPipeline& pipeline = variant(effects, false);
  pass.graph.add("path_trace", pass.owner,
                 {{pass.tlas, gpu::use::trace},
                  {pass.instances, gpu::use::ray_read},
                  {&view.constants, gpu::use::ray_read},
                  {&view.visibility, gpu::use::ray_read},
                  {&view.radiance, gpu::use::ray_write},
                  {&view.path_info, gpu::use::ray_write}},
                 [&pipeline, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline);
                   commands.push(sample);
                   commands.traceRays(pipeline, view.settings().width, view.settings().height);
                 });
}

void PathTrace::addLog(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) {
  View& view = pass.view;
  const gpu::RayTracingPipeline& pipeline = variant(effects, true);
  pass.graph.add("log_rays", pass.owner,
                 {{pass.tlas, gpu::use::trace},
                  {pass.instances, gpu::use::ray_read},
                  {&view.constants, gpu::use::ray_read},
                  {&view.visibility, gpu::use::ray_read},
                  {&view.ray_log, gpu::use::ray_write}},
                 [&pipeline, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline);
                   commands.push(sample);
                   commands.traceRays(pipeline, view.settings().width, view.settings().height);
                 });
}

}  // namespace helio::render
