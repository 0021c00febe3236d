#include "render/passes/culling_view.h"

namespace helio::render {
namespace {
constexpr size_t kShownConstant = 47, kConstants = 48;  // its id in culling_view.comp
}

void CullingViewPass::add(const ViewPass& pass, const shared::SampleConstants& sample) {
  View& view = pass.view;
  const auto shown = static_cast<uint32_t>(view.settings().culling_view);
  gpu::ComputePipeline& pipeline = variants_[shown];
  if (!pipeline) {
    effects::EffectSet effects;
    effects.bits = ~0u;
    gpu::Specialisation constants = effects::specialisation(effects);
    constants.resize(kConstants);
    constants[kShownConstant] = shown;
    pipeline = gpu::ComputePipeline(device_, "culling_view/culling_view.comp", constants);
  }
  std::vector<Access> uses{{&view.visibility, gpu::use::compute_read},
                           {pass.instances, gpu::use::compute_read},
                           {&view.constants, gpu::use::compute_read},
                           {&view.path_info, gpu::use::compute_read},
                           {&view.radiance, gpu::use::compute_write}};
  if (pass.hits) uses.push_back({pass.hits, gpu::use::compute_read});
  pass.graph.add("culling_view", pass.owner, std::move(uses), [&pipeline, &view, sample](gpu::Commands& commands) {
    commands.bind(pipeline);
    commands.push(sample);
    dispatchOver(commands, view, 8);
  });
}

}  // namespace helio::render
