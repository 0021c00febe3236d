#include "render/passes/reconstruct.h"

namespace helio::render {
namespace {
// Their ids in lib/effects.glsl and reconstruct.comp.
constexpr size_t kIndirectRateConstant = 54, kReuseConstant = 56, kConstants = 57;
}  // namespace

Reconstruct::Reconstruct(gpu::Device& device) {
  for (const IndirectRate rate : {IndirectRate::half, IndirectRate::quarter})
    for (const Reconstruction reconstruction : {Reconstruction::reuse, Reconstruction::bilateral}) {
      gpu::Specialisation constants(kConstants);
      constants[kIndirectRateConstant] = static_cast<uint32_t>(rate);
      constants[kReuseConstant] = reconstruction == Reconstruction::reuse;
      pipelines_[rate == IndirectRate::quarter][static_cast<size_t>(reconstruction)] =
          gpu::ComputePipeline(device, "indirect/reconstruct.comp", constants);
    }
}

void Reconstruct::add(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  const ViewSettings& settings = view.settings();
  const Histories& h = view.histories;
  const gpu::ComputePipeline& pipeline =
      pipelines_[settings.indirect_rate == IndirectRate::quarter][static_cast<size_t>(settings.reconstruction)];
  pass.graph.add("reconstruct", pass.owner,
                 {{&h.indirect, gpu::use::compute_read},
                  {&h.surface(), gpu::use::compute_read},
                  {&h.motion, gpu::use::compute_read},
                  {&view.constants, gpu::use::compute_read},
                  {&h.sampled, gpu::use::compute_write},
                  {&view.radiance, gpu::use::compute_write}},
                 [&pipeline, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline);
                   commands.push(sample);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
