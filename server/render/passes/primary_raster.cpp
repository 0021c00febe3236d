#include "render/passes/primary_raster.h"

#include "shared/draw.h"

namespace helio::render {

PrimaryRaster::PrimaryRaster(gpu::Device& device) : device_(device) {
  for (const bool masks : {false, true}) {
    // A mask may need any texture coordinates and vertex colours: all effects, or none but what moves vertices.
    effects::EffectSet effects;
    effects.add(effects::Effect::deforming);
    if (masks) effects.bits = ~0u;
    pipelines_[masks] = gpu::RasterPipeline(device, {"primary/primary.vert",
                                                     "primary/primary.frag",
                                                     {VK_FORMAT_R32G32_UINT},
                                                     VK_FORMAT_D32_SFLOAT,
                                                     effects::specialisation(effects)});
  }
}

void PrimaryRaster::add(const ViewPass& pass, const DrawList& list, const SceneResources& scene,
                        const glm::vec2& jitter, effects::EffectSet effects) const {
  View& view = pass.view;
  const bool any_masks = effects.has(effects::Effect::alpha_masks);
  pass.graph.add("draw_list", pass.owner, {{&view.slots, gpu::use::transfer_write}},
                 [this, &view, &list](gpu::Commands& commands) {
                   if (view.slots.size() < list.slots.size() * sizeof(uint32_t)) {
                     if (view.slots) commands.retire(std::move(view.slots));
                     view.slots = gpu::Buffer(device_, {"the draw list", list.slots.size() * sizeof(uint32_t) * 3 / 2,
                                                        gpu::MemoryCategory::raster});
                   }
                   commands.upload<uint32_t>(view.slots, 0, list.slots);
                 });

  pass.graph.add("primary_raster", pass.owner,
                 {{&view.slots, gpu::use::raster_read},
                  {&view.constants, gpu::use::raster_read},
                  {pass.instances, gpu::use::raster_read},
                  {&view.visibility, gpu::use::color_write},
                  {&view.depth, gpu::use::depth_write}},
                 [this, &view, &list, &scene, jitter, any_masks](gpu::Commands& commands) {
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
                   const VkViewport viewport{
                       0.0f, 0.0f, static_cast<float>(extent.width), static_cast<float>(extent.height), 0.0f, 1.0f};
                   const VkRect2D scissor{{0, 0}, extent};
                   vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
                   vkCmdSetScissor(commands.handle(), 0, 1, &scissor);
                   for (const bool masks : {false, true}) {
                     if (masks && !any_masks) break;
                     commands.bind(pipelines_[masks]);
                     for (const MeshDraw& draw : list.draws) {
                       const std::vector<DrawGeometry>& geometries = scene.draws()[draw.mesh];
                       for (uint32_t g = 0; g < geometries.size(); ++g) {
                         if (geometries[g].cut_out != masks) continue;
                         const shared::DrawConstants constants{view.constants.address(),
                                                               view.slots.address(),
                                                               geometries[g].positions,
                                                               geometries[g].indices,
                                                               jitter,
                                                               g};
                         commands.push(constants);
                         vkCmdDraw(commands.handle(), geometries[g].index_count, draw.count, 0, draw.first);
                       }
                     }
                   }
                   vkCmdEndRendering(commands.handle());
                 });
}

uint64_t PrimaryRaster::triangles(const DrawList& list, const SceneResources& scene) {
  uint64_t count = 0;
  for (const MeshDraw& draw : list.draws)
    for (const DrawGeometry& geometry : scene.draws()[draw.mesh])
      count += uint64_t{draw.count} * (geometry.index_count / 3);
  return count;
}

}  // namespace helio::render
