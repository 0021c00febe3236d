#include "render/passes/primary_raster.h"

#include "render/camera_frame.h"

namespace helio::render {

effects::EffectSet effectsOfRaster(bool masks) {
  effects::EffectSet effects;
  effects.add(effects::Effect::deforming);
  if (masks) effects.bits = ~0u;
  return effects;
}

std::array<gpu::RasterPipeline, 2> rasterPipelines(gpu::Device& device, gpu::RasterDescription description) {
  std::array<gpu::RasterPipeline, 2> pipelines;
  for (const bool masks : {false, true}) {
    description.constants = effects::specialisation(effectsOfRaster(masks));
    pipelines[masks] = gpu::RasterPipeline(device, description);
  }
  return pipelines;
}

PrimaryRaster::PrimaryRaster(gpu::Device& device)
    : pipelines_(rasterPipelines(
          device, {"primary/primary.vert", "primary/primary.frag", {VK_FORMAT_R32G32_UINT}, VK_FORMAT_D32_SFLOAT, {}})),
      compute_(device, RasterTarget::picture),
      resolve_(device, "raster/resolve.comp") {}

void PrimaryRaster::add(const ViewPass& pass, const RasterPass& raster, const glm::vec2& jitter) const {
  View& view = pass.view;
  const ViewSettings& settings = view.settings();
  const shared::DrawVolume volume =
      cameraVolume(view.camera(), settings.width, settings.height, settings.levels_of_detail ? kPixelsOff : 0.0f);
  pass.graph.add("cull", pass.owner,
                 {{&raster.table, gpu::use::compute_read},
                  {pass.instances, gpu::use::compute_read},
                  {&view.draws, DrawLists::kWrite}},
                 [&view, raster, volume](gpu::Commands& commands) {
                   view.draws.cull(commands, raster.culling, raster.scene, raster.table, raster.instances,
                                   std::span(&volume, 1));
                 });

  const bool any_masks = raster.effects.has(effects::Effect::alpha_masks);
  if (view.computesPrimary())
    pass.graph.add(
        "primary_raster", pass.owner,
        {{&view.draws, ComputeRaster::kDraw},
         {&view.constants, gpu::use::compute_read},
         {pass.instances, gpu::use::compute_read},
         {&view.keys, DrawLists::kWrite},
         {&view.raster_parts, DrawLists::kWrite},
         {&view.visibility, gpu::use::compute_write}},
        [this, &view, jitter, any_masks](gpu::Commands& commands) { compute(commands, view, jitter, any_masks); });
  else
    pass.graph.add(
        "primary_raster", pass.owner,
        {{&view.draws, DrawLists::kDraw},
         {&view.constants, gpu::use::raster_read},
         {pass.instances, gpu::use::raster_read},
         {&view.visibility, gpu::use::color_write},
         {&view.depth, gpu::use::depth_write}},
        [this, &view, jitter, any_masks](gpu::Commands& commands) { draw(commands, view, jitter, any_masks); });
}

void PrimaryRaster::draw(gpu::Commands& commands, const View& view, const glm::vec2& jitter, bool any_masks) const {
  const VkExtent2D extent{view.settings().width, view.settings().height};
  VkRenderingAttachmentInfo color{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  color.imageView = view.visibility.view();
  color.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
  color.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  color.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  color.clearValue.color.uint32[1] = shared::kNothing;
  VkRenderingAttachmentInfo depth = color;
  depth.imageView = view.depth.view();
  depth.storeOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
  depth.clearValue = {};  // reversed: 0 is infinitely far
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea.extent = extent;
  rendering.layerCount = 1;
  rendering.colorAttachmentCount = 1;
  rendering.pColorAttachments = &color;
  rendering.pDepthAttachment = &depth;
  vkCmdBeginRendering(commands.handle(), &rendering);
  const VkViewport viewport{0.0f, 0.0f, static_cast<float>(extent.width), static_cast<float>(extent.height),
                            0.0f, 1.0f};
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
  vkCmdSetScissor(commands.handle(), 0, 1, &scissor);
  shared::DrawConstants constants{};
  constants.frame = view.constants.address();
  constants.jitter = jitter;
  for (const bool masks : {false, true}) {
    if (masks && !any_masks) break;
    commands.bind(pipelines_[masks]);
    view.draws.draw(commands, 0, masks, constants);
  }
  vkCmdEndRendering(commands.handle());
}

void PrimaryRaster::compute(gpu::Commands& commands, const View& view, const glm::vec2& jitter, bool any_masks) const {
  shared::RasterConstants constants{};
  constants.frame = view.constants.address();
  constants.keys = view.keys.address();
  constants.jitter = jitter;
  constants.width = view.settings().width;
  constants.height = view.settings().height;
  commands.fill(view.keys, 0);
  compute_.draw(commands, view.draws, 1, any_masks, view.raster_parts, constants);
  commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
  view.draws.describe(0, constants);
  commands.bind(resolve_);
  commands.push(constants);
  dispatchOver(commands, view, 8);
}

}  // namespace helio::render
