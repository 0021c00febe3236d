#include "render/passes/reblur.h"

#include "shared/filter.h"

namespace helio::render {
namespace {

// The stages of reblur/blur.comp.
constexpr uint32_t kPreblur = 0, kBlur = 1, kPostblur = 2;

shared::FilterConstants filterConstants(const View& view, const gpu::Image& from, const gpu::Image& to) {
  shared::FilterConstants constants{};
  constants.frame = view.constants.address();
  constants.source = from.slot();
  constants.target = to.slot();
  constants.mean = view.accumulation.slot();
  return constants;
}

}  // namespace

Reblur::Reblur(gpu::Device& device)
    : preblur_(device, "reblur/blur.comp", {kPreblur}),
      temporal_(device, "reblur/temporal.comp"),
      mip_(device, "reblur/mip.comp"),
      fix_(device, "reblur/history_fix.comp"),
      blur_(device, "reblur/blur.comp", {kBlur}),
      postblur_(device, "reblur/blur.comp", {kPostblur}),
      stabilise_(device, "reblur/stabilise.comp") {}

void Reblur::add(const ViewPass& pass, const shared::SampleConstants& /*sample*/,
                 const shared::SampleConstants& last) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  const auto filter = [&view](gpu::Commands& commands, const gpu::ComputePipeline& pipeline, const gpu::Image& from,
                              const gpu::Image& to) {
    commands.bind(pipeline);
    commands.push(filterConstants(view, from, to));
    dispatchOver(commands, view, 8);
  };
  // Samples, blurred, to the spare image; what was shown in the tick before leaves it first.
  pass.graph.add(
      "reblur_preblur", pass.owner,
      {{&h.sampled, gpu::use::compute_read},
       {&h.surface(), gpu::use::compute_read},
       {&h.motion, gpu::use::compute_read},
       {&h.stabilised, gpu::use::compute_write},
       {&h.spare, gpu::use::compute_write}},
      [this, &h, filter](gpu::Commands& commands) { filter(commands, preblur_, h.sampled.rgb, h.spare.rgb); });

  pass.graph.add(
      "reblur_temporal", pass.owner,
      {{&h.spare, gpu::use::compute_read},
       {&h.surface(), gpu::use::compute_write},
       {&h.filtered, gpu::use::compute_read},
       {&h.samples, gpu::use::compute_read},
       {&h.sunlight(), gpu::use::compute_read},
       {&h.stabilised, gpu::use::compute_read},
       {&h.sampled, gpu::use::compute_write}},
      [this, &h, filter](gpu::Commands& commands) { filter(commands, temporal_, h.spare.rgb, h.sampled.rgb); });

  pass.graph.add("reblur_history_fix", pass.owner,
                 {{&h.sampled, gpu::use::compute_read},
                  {&h.mips, gpu::use::compute_write},
                  {&h.samples, gpu::use::compute_write},
                  {&h.spare, gpu::use::compute_write}},
                 [this, &view, &h, filter](gpu::Commands& commands) {
                   commands.bind(mip_);
                   for (uint32_t level = 0; level < shared::kHistoryMips; ++level) {
                     shared::FilterConstants constants =
                         filterConstants(view, level == 0 ? h.sampled.rgb : h.mips[level - 1], h.mips[level]);
                     constants.stride = 2u << level;
                     commands.push(constants);
                     commands.dispatch((h.mips[level].width() + 7) / 8, (h.mips[level].height() + 7) / 8);
                     commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                   }
                   filter(commands, fix_, h.sampled.rgb, h.spare.rgb);
                 });

  pass.graph.add("reblur_blur", pass.owner,
                 {{&h.spare, gpu::use::compute_read},
                  {&h.samples, gpu::use::compute_read},
                  {&h.sampled, gpu::use::compute_write},
                  {&h.filtered, gpu::use::compute_write}},
                 [this, &h, filter](gpu::Commands& commands) {
                   filter(commands, blur_, h.spare.rgb, h.sampled.rgb);
                   commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                   filter(commands, postblur_, h.sampled.rgb, h.filtered);
                 });

  pass.graph.add("reblur_stabilise", pass.owner,
                 {{&h.filtered, gpu::use::compute_read},
                  {&h.stabilised, gpu::use::compute_read},
                  {&h.samples, gpu::use::compute_write},
                  {&h.spare, gpu::use::compute_write},
                  {&view.accumulation, gpu::use::compute_read},
                  {&view.radiance, gpu::use::compute_write}},
                 [this, &view, &h, last](gpu::Commands& commands) {
                   shared::FilterConstants constants = filterConstants(view, h.filtered, h.spare.deviation);
                   constants.accumulated = view.still() ? last.accumulated : 0;
                   commands.bind(stabilise_);
                   commands.push(constants);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
