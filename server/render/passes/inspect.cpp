#include "render/passes/inspect.h"

namespace helio::render {
namespace {
constexpr size_t kInspectConstant = 47, kConstants = 48;  // its id in inspect.comp
}

void InspectPass::add(const ViewPass& pass, const shared::SampleConstants& sample) {
  View& view = pass.view;
  gpu::ComputePipeline& pipeline = variants_[static_cast<size_t>(view.settings().inspect)];
  if (!pipeline) {
    effects::EffectSet effects;
    effects.bits = ~0u;
    gpu::Specialisation constants = effects::specialisation(effects);
    constants.resize(kConstants);
    constants[kInspectConstant] = static_cast<uint32_t>(view.settings().inspect);
    pipeline = gpu::ComputePipeline(device_, "inspect/inspect.comp", constants);
  }
  const Histories& h = view.histories;
  pass.graph.add("inspect", pass.owner,
                 {{&view.visibility, gpu::use::compute_read},
                  {pass.instances, gpu::use::compute_read},
                  {&view.constants, gpu::use::compute_read},
                  {&h.motion, gpu::use::compute_read},
                  {&h.sampled, gpu::use::compute_read},
                  {&h.filtered, gpu::use::compute_read},
                  {&h.moments, gpu::use::compute_read},
                  {&view.radiance, gpu::use::compute_write}},
                 [&pipeline, &view, sample](gpu::Commands& commands) {
                   commands.bind(pipeline);
                   commands.push(sample);
                   dispatchOver(commands, view, 8);
                 });
}

}  // namespace helio::render
