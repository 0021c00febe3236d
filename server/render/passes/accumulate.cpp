#include "render/passes/accumulate.h"

namespace helio::render {

Accumulate::Accumulate(gpu::Device& device) : pipeline_(device, "accumulate/accumulate.comp") {}

void Accumulate::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  pass.graph.add("accumulate", pass.owner,
                 {{&view.radiance, gpu::use::compute_read},
                  {&view.accumulation, gpu::use::compute_write},
                  {&view.state, gpu::use::compute_write},
                  {&view.constants, gpu::use::compute_read}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline_);
                   commands.push(sample);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
