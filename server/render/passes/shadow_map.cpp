#include "render/passes/shadow_map.h"

#include <algorithm>
#include <cmath>

namespace helio::render {
namespace {

constexpr float kNearest = 24.0f;                            // metres: half the side of the first cascade
constexpr float kAhead = 0.6f;                               // of that, from the camera to its centre
constexpr float kTexelsOff = 3.0f;                           // that a level of detail may differ from the finest
constexpr float kLeastTexels = 1.0f;                         // what is smaller is left out
constexpr float kFinerTexels = 4.0f, kCoarserTexels = 3.0f;  // of the lookups' edge, lift and filter
constexpr uint32_t kTilesPerRow = shared::kShadowTilesPerRow;

/// The next power of 1.25: a world that grows a little must not move its shadows.
float roundedUp(float metres) { return std::exp2(std::ceil(std::log2(metres) / 0.3219281f) * 0.3219281f); }

/// What casts shadows into cascade `c`: no bound towards the sun. Whose shadow falls into the finer cascade as a whole
/// is not looked for in this one.
shared::DrawVolume casters(const shared::ShadowMap& map, uint32_t c, bool levels) {
  const shared::ShadowCascade& cascade = map.cascades[c];
  const auto texel = [&map](const shared::ShadowCascade& of) {
    return 2.0f * of.half_width / static_cast<float>(map.tile);
  };
  const shared::ShadowCascade* finer = c > 0 ? &map.cascades[c - 1] : nullptr;
  // From there on outwards lookups lie in this cascade, and they reach a little inwards (lib/shadow_map.glsl).
  const float reach = finer ? kFinerTexels * texel(*finer) + kCoarserTexels * texel(cascade) : 0.0f;
  shared::DrawVolume volume{};
  volume.has_inner = finer != nullptr;
  for (const glm::vec3& inward : {map.right, -map.right, map.up, -map.up}) {
    const auto i = static_cast<int>(volume.plane_count++);
    volume.planes[i] = glm::vec4(inward, cascade.half_width - glm::dot(inward, cascade.centre));
    if (finer) volume.inner[i] = finer->half_width - reach - glm::dot(inward, finer->centre);
  }
  volume.eye = cascade.centre;
  volume.error = levels ? kTexelsOff * texel(cascade) : -1.0f;
  volume.error_per_metre = levels ? 0.0f : -1.0f;
  volume.least = levels ? kLeastTexels * texel(cascade) : 0.0f;
  return volume;
}

}  // namespace

shared::ShadowMap shadowCascades(const scene::Camera& camera, const glm::vec3& to_sun, const accel::OrderBlock& world,
                                 uint32_t tile) {
  shared::ShadowMap map{};
  map.to_sun = to_sun;
  const glm::vec3 aside = std::abs(to_sun.y) < 0.99f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
  map.right = glm::normalize(glm::cross(aside, to_sun));
  map.up = glm::cross(to_sun, map.right);
  map.tile = tile;
  const float largest = roundedUp(std::max(world.radius * 1.02f, 2.0f * kNearest));
  const glm::vec3 forward = glm::normalize(camera.forward);
  float farthest = 0.0f;
  for (uint32_t c = 0; c < shared::kShadowCascades; ++c) {
    shared::ShadowCascade& cascade = map.cascades[c];
    const bool whole_world = c + 1 == shared::kShadowCascades;
    cascade.half_width = kNearest * std::pow(largest / kNearest, static_cast<float>(c) / (shared::kShadowCascades - 1));
    const glm::vec3 centre = whole_world ? world.centre : camera.position + forward * (kAhead * cascade.half_width);
    const float texel = 2.0f * cascade.half_width / static_cast<float>(tile);
    const auto snapped = [&](const glm::vec3& axis) { return texel * std::floor(glm::dot(centre, axis) / texel); };
    cascade.centre = map.right * snapped(map.right) + map.up * snapped(map.up) + to_sun * glm::dot(centre, to_sun);
    farthest = std::max(farthest, glm::distance(centre, world.centre));
  }
  map.half_depth = roundedUp(largest + farthest);
  return map;
}

ShadowMapPass::ShadowMapPass(gpu::Device& device)
    : pipelines_(rasterPipelines(
          device, {"shadow_map/shadow_map.vert", "shadow_map/shadow_map.frag", {}, VK_FORMAT_D32_SFLOAT, {}})),
      compute_(device, RasterTarget::shadow_map),
      clear_(device, "raster/clear.comp") {}

void ShadowMapPass::add(const ViewPass& pass, const RasterPass& raster, const glm::vec3& to_sun,
                        const accel::OrderBlock& world, const ShadowCasters& only) const {
  View& view = pass.view;
  const ViewSettings& settings = view.settings();
  shared::ShadowMap map = shadowCascades(view.camera(), to_sun, world, settings.shadow_map_size);
  map.image = view.shadow_image.slot();
  map.bits = view.computesShadows();
  std::array<shared::DrawVolume, shared::kShadowCascades> volumes{};
  for (uint32_t c = 0; c < shared::kShadowCascades; ++c) volumes[c] = casters(map, c, settings.levels_of_detail);

  std::vector<Access> accesses{{&raster.table, gpu::use::compute_read},
                               {pass.instances, gpu::use::compute_read},
                               {&view.shadow_draws, DrawLists::kWrite},
                               {&view.shadow_constants, gpu::use::transfer_write}};
  if (only.table) accesses.push_back({only.written_with, gpu::use::compute_read});
  pass.graph.add("shadow_cull", pass.owner, std::move(accesses),
                 [&view, raster, map, volumes, table = only.table](gpu::Commands& commands) {
                   commands.upload<shared::ShadowMap>(view.shadow_constants, 0, std::span(&map, 1));
                   view.shadow_draws.cull(commands, raster.culling, raster.scene, raster.table, raster.instances,
                                          volumes, table ? table->address() : 0);
                 });

  const bool any_masks = raster.effects.has(effects::Effect::alpha_masks);
  const uint32_t tile = map.tile;
  if (view.computesShadows())
    pass.graph.add(
        "shadow_map", pass.owner,
        {{&view.shadow_draws, ComputeRaster::kDraw},
         {&view.shadow_constants, gpu::use::compute_read},
         {&view.constants, gpu::use::compute_read},
         {pass.instances, gpu::use::compute_read},
         {&view.raster_parts, DrawLists::kWrite},
         {&view.shadow_image, DrawLists::kWrite}},
        [this, &view, tile, any_masks](gpu::Commands& commands) { compute(commands, view, tile, any_masks); });
  else
    pass.graph.add("shadow_map", pass.owner,
                   {{&view.shadow_draws, DrawLists::kDraw},
                    {&view.shadow_constants, gpu::use::raster_read},
                    {&view.constants, gpu::use::raster_read},
                    {pass.instances, gpu::use::raster_read},
                    {&view.shadow_image, gpu::use::depth_write}},
                   [this, &view, tile, any_masks](gpu::Commands& commands) { draw(commands, view, tile, any_masks); });
}

void ShadowMapPass::draw(gpu::Commands& commands, const View& view, uint32_t tile, bool any_masks) const {
  VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  depth.imageView = view.shadow_image.view();
  depth.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
  depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;  // to 0: nothing between here and the sun
  depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  VkRenderingInfo rendering{VK_STRUCTURE_TYPE_RENDERING_INFO};
  rendering.renderArea.extent = {kTilesPerRow * tile, kTilesPerRow * tile};
  rendering.layerCount = 1;
  rendering.pDepthAttachment = &depth;
  vkCmdBeginRendering(commands.handle(), &rendering);
  shared::DrawConstants constants{};
  constants.frame = view.constants.address();
  constants.shadow_map = view.shadow_constants.address();
  for (const bool masks : {false, true}) {
    if (masks && !any_masks) break;
    commands.bind(pipelines_[masks]);
    for (uint32_t c = 0; c < shared::kShadowCascades; ++c) {
      const uint32_t x = c % kTilesPerRow * tile, y = c / kTilesPerRow * tile;
      const VkViewport viewport{
          static_cast<float>(x), static_cast<float>(y), static_cast<float>(tile), static_cast<float>(tile), 0.0f, 1.0f};
      const VkRect2D scissor{{static_cast<int32_t>(x), static_cast<int32_t>(y)}, {tile, tile}};
      vkCmdSetViewport(commands.handle(), 0, 1, &viewport);
      vkCmdSetScissor(commands.handle(), 0, 1, &scissor);
      constants.cascade = c;
      view.shadow_draws.draw(commands, c, masks, constants);
    }
  }
  vkCmdEndRendering(commands.handle());
}

void ShadowMapPass::compute(gpu::Commands& commands, const View& view, uint32_t tile, bool any_masks) const {
  shared::RasterConstants constants{};
  constants.frame = view.constants.address();
  constants.shadow_map = view.shadow_constants.address();
  constants.image = view.shadow_image.slot();
  constants.width = constants.height = tile;
  const uint32_t groups = (kTilesPerRow * tile + 15) / 16;
  commands.bind(clear_);
  commands.push(constants);
  commands.dispatch(groups, groups);  // draw() waits for it
  compute_.draw(commands, view.shadow_draws, shared::kShadowCascades, any_masks, view.raster_parts, constants);
}

}  // namespace helio::render
