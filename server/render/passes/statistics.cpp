#include "render/passes/statistics.h"

namespace helio::render {

Statistics::Statistics(gpu::Device& device) : pipeline_(device, "statistics/statistics.comp") {}

void Statistics::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  pass.graph.add("statistics", pass.owner,
                 {{&view.path_info, gpu::use::compute_read},
                  {&view.state, gpu::use::compute_write},
                  {&view.constants, gpu::use::compute_read}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline_);
                   commands.push(sample);
                   dispatchOver(commands, view, 16);
                 });
}

void Statistics::recordRound(gpu::Commands& commands, const PathQueue& paths,
                             const shared::SampleConstants& sample) const {
  commands.bind(pipeline_);
  commands.push(sample);
  paths.dispatchRound(commands, sample.tick_sample);
}

}  // namespace helio::render
