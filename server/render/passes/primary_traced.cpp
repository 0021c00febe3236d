#include "render/passes/primary_traced.h"

#include "render/passes/path_trace.h"

namespace helio::render {

PrimaryTraced::PrimaryTraced(gpu::Device& device) : pipeline_(device, describeTrace("primary/primary.rgen", {})) {}

void PrimaryTraced::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  pass.graph.add(
      "primary_traced", pass.owner,
      {{pass.tlas, gpu::use::trace}, {&view.constants, gpu::use::ray_read}, {&view.visibility, gpu::use::ray_write}},
      [this, &view, sample](gpu::Commands& commands) {
        commands.bind(pipeline_);
        commands.push(sample);
        commands.traceRays(pipeline_, view.settings().width, view.settings().height);
      });
}

}  // namespace helio::render
