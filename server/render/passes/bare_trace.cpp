#include "render/passes/bare_trace.h"

#include "render/passes/path_trace.h"

namespace helio::render {

BareTrace::BareTrace(gpu::Device& device) {
  for (const bool masks : {false, true}) {
    effects::EffectSet effects;
    if (masks) effects.add(effects::Effect::alpha_masks);
    pipelines_[masks] = gpu::RayTracingPipeline(device, {"bare_trace/bare_trace.rgen",
                                                         {"bare_trace/bare.rmiss"},
                                                         {{"bare_trace/bare.rchit", anyHit(effects)}},
                                                         effects::specialisation(effects)});
  }
}

void BareTrace::add(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) const {
  View& view = pass.view;
  const gpu::RayTracingPipeline& pipeline = pipelines_[effects.has(effects::Effect::alpha_masks)];
  pass.graph.add("bare_trace", pass.owner,
                 {{pass.tlas, gpu::use::trace},
                  {&view.constants, gpu::use::ray_read},
                  {&view.ray_log, gpu::use::ray_read},
                  {&view.path_info, gpu::use::ray_write}},
                 [&pipeline, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline);
                   commands.push(sample);
                   commands.traceRays(pipeline, view.settings().width, view.settings().height);
                 });
}

}  // namespace helio::render
