#include "render/passes/motion.h"

namespace helio::render {

void Motion::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  pass.graph.add("motion", pass.owner,
                 {{&view.visibility, gpu::use::compute_read},
                  {pass.instances, gpu::use::compute_read},
                  {&view.constants, gpu::use::compute_read},
                  {&view.histories.surface(), gpu::use::compute_read},
                  {&view.histories.spare, gpu::use::compute_read},
                  {&view.histories.motion, gpu::use::compute_write}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline_);
                   commands.push(sample);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
