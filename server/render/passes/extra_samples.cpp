#include "render/passes/extra_samples.h"

#include "shared/extra_samples.h"

namespace helio::render {

ExtraSamplesPass::ExtraSamplesPass(gpu::Device& device)
    : weigh_(device, "extra_samples/weigh.comp"),
      share_(device, "extra_samples/share.comp"),
      choose_(device, "extra_samples/choose.comp"),
      list_(device, "extra_samples/list.comp") {}

void ExtraSamplesPass::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  pass.graph.add("extra_samples", pass.owner,
                 {{&h.motion, gpu::use::compute_read},
                  {&h.surface(), gpu::use::compute_read},
                  {&h.sampled, gpu::use::compute_read},
                  {&h.sunlight(), gpu::use::compute_read},
                  {&view.constants, gpu::use::compute_read},
                  {&view.path_info, gpu::use::compute_write},
                  {&view.state, gpu::use::compute_write},
                  {&pass.paths, PathQueue::kUse}},
                 [this, &view, &paths = pass.paths, sample](gpu::Commands& commands) {
                   paths.clearExtra(commands);
                   commands.barrier(gpu::use::transfer_write, gpu::use::compute_write);
                   commands.bind(weigh_);
                   commands.push(sample);
                   dispatchOver(commands, view, shared::kExtraTile);
                   commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                   commands.bind(share_);
                   commands.push(sample);
                   commands.dispatch(1);
                   commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                   commands.bind(choose_);
                   commands.push(sample);
                   dispatchOver(commands, view, shared::kExtraTile);
                   commands.barrier(gpu::use::compute_write, PathQueue::kUse);
                   commands.bind(list_);
                   commands.push(sample);
                   paths.dispatchListing(commands);
                 });
}

}  // namespace helio::render
