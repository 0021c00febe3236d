#include "render/passes/sunlight.h"

namespace helio::render {

void Sunlight::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  pass.graph.add("sunlight", pass.owner,
                 {{&h.surface(), gpu::use::compute_read},
                  {&h.motion, gpu::use::compute_read},
                  {&h.samples, gpu::use::compute_read},
                  {&h.sampled, gpu::use::compute_read},
                  {&h.albedos, gpu::use::compute_read},
                  {&h.spare, gpu::use::compute_write},  // which may hold the sun's light
                  {&h.emission, gpu::use::compute_write},
                  {&h.sunlight(), gpu::use::compute_write}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline_);
                   commands.push(sample);
                   dispatchOver(commands, view, 16);
                 });
}

}  // namespace helio::render
