#include "render/passes/error_estimate.h"

namespace helio::render {

void ErrorEstimate::add(const ViewPass& pass, const shared::SampleConstants& last) const {
  View& view = pass.view;
  pass.graph.add("error_estimate", pass.owner,
                 {{&view.radiance, gpu::use::compute_read},
                  {&view.state, gpu::use::compute_write},
                  {&view.constants, gpu::use::compute_read}},
                 [this, &view, last](gpu::Commands& commands) {
                   commands.bind(pipeline_);
                   commands.push(last);
                   dispatchOver(commands, view, 16);
                 });
}

double ErrorEstimate::variance(const shared::ViewState& state, uint64_t pixels) {
  const uint64_t sum = uint64_t{state.variance_high} << 32 | state.variance_low;
  return static_cast<double>(sum) / shared::kVarianceUnits / static_cast<double>(pixels);
}

}  // namespace helio::render
