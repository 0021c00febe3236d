#include "render/passes/taa.h"

#include "shared/taa.h"

namespace helio::render {

void Taa::add(const ViewPass& pass) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  pass.graph.add("taa", pass.owner,
                 {{&h.motion, gpu::use::compute_read},
                  {&h.antialiased, gpu::use::compute_write},
                  {&h.spare, gpu::use::compute_write},
                  {&view.constants, gpu::use::compute_read},
                  {&view.radiance, gpu::use::compute_write}},
                 [this, &view](gpu::Commands& commands) {
                   const Histories& images = view.histories;
                   const shared::TaaConstants constants{view.constants.address(), images.antialiased.slot(),
                                                        images.resolved().slot()};
                   commands.bind(resolve_);
                   commands.push(constants);
                   dispatchOver(commands, view, 8);
                   commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                   commands.bind(show_);
                   commands.push(constants);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
