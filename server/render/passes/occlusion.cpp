#include "render/passes/occlusion.h"

namespace helio::render {

void Occlusion::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  pass.graph.add("occlusion", pass.owner,
                 {{&h.surface(), gpu::use::compute_read},
                  {&h.motion, gpu::use::compute_read},
                  {&h.sampled, gpu::use::compute_read},
                  {&h.albedos, gpu::use::compute_read},
                  {&h.occlusion, gpu::use::compute_read},
                  {&h.openSky(), gpu::use::compute_write},
                  {&h.emission, gpu::use::compute_write}},
                 [this, &view, sample](gpu::Commands& commands) {
                   commands.bind(temporal_);
                   commands.push(sample);
                   dispatchOver(commands, view, 8);
                   commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                   commands.bind(spatial_);
                   commands.push(sample);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
