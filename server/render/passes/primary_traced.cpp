#include "render/passes/primary_traced.h"

#include "render/passes/path_trace.h"

namespace helio::render {

PrimaryTraced::PrimaryTraced(gpu::Device& device) {
  for (const bool masks : {false, true}) {
    effects::EffectSet effects;
    if (masks) effects.add(effects::Effect::alpha_masks);
    pipelines_[masks] = gpu::RayTracingPipeline(
        device, describeTrace("primary/primary.rgen", effects, effects::specialisation(effects)));
  }
}

void PrimaryTraced::add(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects) const {
  View& view = pass.view;
  const gpu::RayTracingPipeline& pipeline = pipelines_[effects.has(effects::Effect::alpha_masks)];
  pass.graph.add(
      "primary_traced", pass.owner,
      {{pass.tlas, gpu::use::trace}, {&view.constants, gpu::use::ray_read}, {&view.visibility, gpu::use::ray_write}},
      [&pipeline, &view, sample](gpu::Commands& commands) {
        commands.bind(pipeline);
        commands.push(sample);
        commands.traceRays(pipeline, view.settings().width, view.settings().height);
      });
}

}  // namespace helio::render
