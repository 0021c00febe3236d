#include "render/passes/svgf.h"

#include "shared/filter.h"

namespace helio::render {
namespace {

constexpr uint32_t kIterations = 5;

shared::FilterConstants filterConstants(const View& view, const Histories::Light& from, const Histories::Light& to) {
  shared::FilterConstants constants{};
  constants.frame = view.constants.address();
  constants.source = from.rgb.slot();
  constants.source_deviation = from.deviation.slot();
  constants.target = to.rgb.slot();
  constants.target_deviation = to.deviation.slot();
  constants.mean = view.accumulation.slot();
  return constants;
}

/// Groups of 16 x 16 pixels that are a stride apart; those between are other groups' (svgf/atrous.comp).
void dispatchIteration(gpu::Commands& commands, const View& view, uint32_t iteration) {
  const uint32_t stride = 1u << iteration, across = 16 * stride;
  const auto groups = [&](uint32_t pixels) { return (pixels + across - 1) / across * stride; };
  commands.dispatch(groups(view.settings().width), groups(view.settings().height));
}

}  // namespace

Svgf::Svgf(gpu::Device& device, Feedback feedback)
    : feedback_(feedback),
      temporal_(device, "svgf/temporal.comp", {feedback == Feedback::integrated}),
      variance_(device, "svgf/variance.comp", {feedback == Feedback::integrated}) {
  for (uint32_t i = 0; i < kIterations; ++i)
    atrous_.emplace_back(device, "svgf/atrous.comp", gpu::Specialisation{1u << i, i + 1 == kIterations});
}

void Svgf::add(const ViewPass& pass, const shared::SampleConstants& /*sample*/,
               const shared::SampleConstants& last) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  // The samples become their mean over ticks where they are; the filter goes to and fro between the two images of
  // light.
  pass.graph.add("svgf_temporal", pass.owner,
                 {{&h.motion, gpu::use::compute_read},
                  {&h.surface(), gpu::use::compute_write},
                  {&h.filtered, gpu::use::compute_read},
                  {&h.moments, gpu::use::compute_read},
                  {&h.changes, gpu::use::compute_read},
                  {&h.sampled, gpu::use::compute_write},
                  {&h.spare, gpu::use::compute_write}},
                 [this, &view, last](gpu::Commands& commands) {
                   commands.bind(temporal_);
                   commands.push(last);
                   dispatchOver(commands, view, 8);
                 });

  pass.graph.add("svgf_variance", pass.owner,
                 {{&h.sampled, gpu::use::compute_read},
                  {&h.surface(), gpu::use::compute_read},
                  {&h.filtered, gpu::use::compute_write},
                  {&h.moments, gpu::use::compute_write},
                  {&h.spare, gpu::use::compute_write}},
                 [this, &view](gpu::Commands& commands) {
                   commands.bind(variance_);
                   commands.push(filterConstants(view, view.histories.sampled, view.histories.spare));
                   dispatchOver(commands, view, 16);
                 });

  pass.graph.add("svgf_atrous", pass.owner,
                 {{&h.sampled, gpu::use::compute_write},
                  {&h.spare, gpu::use::compute_write},
                  {&h.filtered, gpu::use::compute_write},
                  {&h.moments, gpu::use::compute_read},
                  {&view.accumulation, gpu::use::compute_read},
                  {&view.radiance, gpu::use::compute_write}},
                 [this, &view, last](gpu::Commands& commands) {
                   const std::array<const Histories::Light*, 2> light{&view.histories.spare, &view.histories.sampled};
                   for (uint32_t i = 0; i < kIterations; ++i) {
                     if (i > 0) commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                     shared::FilterConstants constants = filterConstants(view, *light[i % 2], *light[(i + 1) % 2]);
                     constants.keeps = i == 0 && feedback_ == Feedback::filtered;
                     constants.accumulated = view.still() ? last.accumulated : 0;
                     commands.bind(atrous_[i]);
                     commands.push(constants);
                     dispatchIteration(commands, view, i);
                   }
                 });
}

}  // namespace helio::render
