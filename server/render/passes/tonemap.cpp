#include "render/passes/tonemap.h"

namespace helio::render {

Tonemap::Tonemap(gpu::Device& device) : pipeline_(device, "tonemap/tonemap.comp") {}

void Tonemap::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  pass.graph.add("tonemap", pass.owner,
                 {{&view.shown(), gpu::use::compute_read},
                  {&view.state, gpu::use::compute_read},
                  {&view.pixels, gpu::use::compute_write},
                  {&view.constants, gpu::use::compute_read}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline_);
                   commands.push(sample);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
