#include "render/passes/bare_trace.h"

namespace helio::render {

BareTrace::BareTrace(gpu::Device& device)
    : pipeline_(device,
                {"bare_trace/bare_trace.rgen", {"bare_trace/bare.rmiss"}, {{"bare_trace/bare.rchit", ""}}, {}}) {}

void BareTrace::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  pass.graph.add("bare_trace", pass.owner,
                 {{pass.tlas, gpu::use::trace},
                  {&view.constants, gpu::use::ray_read},
                  {&view.ray_log, gpu::use::ray_read},
                  {&view.path_info, gpu::use::ray_write}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline_);
                   commands.push(sample);
                   commands.traceRays(pipeline_, view.settings().width, view.settings().height);
                 });
}

}  // namespace helio::render
