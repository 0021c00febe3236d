#include "render/passes/svgf.h"

#include "shared/filter.h"

namespace helio::render {
namespace {

constexpr uint32_t kIterations = 5;

/// A diffuse and a specular image.
struct Pair {
  const gpu::Image* diffuse;
  const gpu::Image* specular;
};

shared::FilterConstants filterConstants(const View& view, const Pair& from, const Pair& to) {
  shared::FilterConstants constants{};
  constants.frame = view.constants.address();
  constants.source[0] = from.diffuse->slot();
  constants.source[1] = from.specular->slot();
  constants.target[0] = to.diffuse->slot();
  constants.target[1] = to.specular->slot();
  constants.stride = 1;
  constants.mean = view.accumulation.slot();
  return constants;
}

}  // namespace

Svgf::Svgf(gpu::Device& device)
    : temporal_(device, "svgf/temporal.comp"),
      variance_(device, "svgf/variance.comp"),
      atrous_{gpu::ComputePipeline(device, "svgf/atrous.comp", {0}),
              gpu::ComputePipeline(device, "svgf/atrous.comp", {1})} {}

void Svgf::add(const ViewPass& pass, const shared::SampleConstants& last) const {
  View& view = pass.view;
  Histories& h = view.histories;
  // Light that came from one pair of images goes to another; each is free again when the pass behind has read it.
  const Pair sampled{&h.diffuse, &h.specular}, integrated{&h.integrated[0], &h.integrated[1]},
      filtered{&h.filtered[0], &h.filtered[1]};

  pass.graph.add("svgf_temporal", pass.owner,
                 {{sampled.diffuse, gpu::use::compute_read},
                  {&h.motion, gpu::use::compute_read},
                  {&h.surface(), gpu::use::compute_read},
                  {filtered.diffuse, gpu::use::compute_read},
                  {integrated.diffuse, gpu::use::compute_write},
                  {&h.moments(), gpu::use::compute_write}},
                 [this, &view, last](gpu::Commands& commands) {
                   commands.bind(temporal_);
                   commands.push(last);
                   dispatchOver(commands, view, 8);
                 });

  pass.graph.add("svgf_variance", pass.owner,
                 {{integrated.diffuse, gpu::use::compute_read},
                  {&h.surface(), gpu::use::compute_read},
                  {&h.moments(), gpu::use::compute_read},
                  {sampled.diffuse, gpu::use::compute_write}},
                 [this, &view, integrated, sampled](gpu::Commands& commands) {
                   commands.bind(variance_);
                   commands.push(filterConstants(view, integrated, sampled));
                   dispatchOver(commands, view, 8);
                 });

  pass.graph.add("svgf_atrous", pass.owner,
                 {{sampled.diffuse, gpu::use::compute_write},
                  {integrated.diffuse, gpu::use::compute_write},
                  {filtered.diffuse, gpu::use::compute_write},
                  {&view.accumulation, gpu::use::compute_read},
                  {&view.radiance, gpu::use::compute_write}},
                 [this, &view, sampled, integrated, filtered, last](gpu::Commands& commands) {
                   const std::array<Pair, kIterations + 1> chain{sampled, filtered,   integrated,
                                                                 sampled, integrated, sampled};
                   for (uint32_t i = 0; i < kIterations; ++i) {
                     if (i > 0) commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                     shared::FilterConstants constants = filterConstants(view, chain[i], chain[i + 1]);
                     constants.stride = 1u << i;
                     constants.accumulated = view.still() ? last.accumulated : 0;
                     commands.bind(atrous_[i + 1 == kIterations]);
                     commands.push(constants);
                     dispatchOver(commands, view, 8);
                   }
                 });
}

}  // namespace helio::render
