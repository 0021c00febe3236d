#include "render/passes/exposure.h"

namespace helio::render {

Exposure::Exposure(gpu::Device& device)
    : histogram_(device, "exposure/histogram.comp"), exposure_(device, "exposure/exposure.comp") {}

void Exposure::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  pass.graph.add("histogram", pass.owner,
                 {{&view.shown(), gpu::use::compute_read},
                  {&view.state, gpu::use::compute_write},
                  {&view.constants, gpu::use::compute_read}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(histogram_);
                   commands.push(sample);
                   dispatchOver(commands, view, 16);
                 });
  pass.graph.add("exposure", pass.owner,
                 {{&view.state, gpu::use::compute_write}, {&view.constants, gpu::use::compute_read}},
                 [this, sample](gpu::Commands& commands) {
                   commands.bind(exposure_);
                   commands.push(sample);
                   commands.dispatch(1);
                 });
}

}  // namespace helio::render
