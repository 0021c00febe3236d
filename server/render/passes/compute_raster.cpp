#include "render/passes/compute_raster.h"

#include "render/passes/primary_raster.h"

namespace helio::render {
namespace {

constexpr size_t kShadowMapConstant = 60;
}  // namespace

ComputeRaster::ComputeRaster(gpu::Device& device, RasterTarget target) {
  for (const bool masks : {false, true}) {
    gpu::Specialisation constants = effects::specialisation(effectsOfRaster(masks));
    constants.resize(kShadowMapConstant + 1);
    constants[kShadowMapConstant] = target == RasterTarget::shadow_map;
    triangles_[masks] = gpu::ComputePipeline(device, "raster/triangles.comp", constants);
    tiles_[masks] = gpu::ComputePipeline(device, "raster/tiles.comp", constants);
  }
}

void ComputeRaster::draw(gpu::Commands& commands, const DrawLists& lists, uint32_t volumes, bool any_masks,
                         const gpu::Buffer& tiles, shared::RasterConstants constants) const {
  // Each volume has its share of the tiles, so that all of them are drawn at once.
  constants.tile_capacity =
      static_cast<uint32_t>((tiles.size() / volumes - sizeof(shared::RasterTileCount)) / sizeof(shared::RasterTile));
  const uint64_t share =
      sizeof(shared::RasterTileCount) + uint64_t{constants.tile_capacity} * sizeof(shared::RasterTile);
  for (uint32_t v = 0; v < volumes; ++v)
    vkCmdFillBuffer(commands.handle(), tiles.handle(), v * share, sizeof(shared::RasterTileCount), 0);
  commands.barrier(gpu::use::transfer_write, gpu::use::compute_write);
  const auto volume = [&](uint32_t v) {
    lists.describe(v, constants);
    constants.tiles = tiles.address() + v * share;
    constants.cascade = v;
    commands.push(constants);
  };
  for (const bool masks : {false, true}) {
    if (masks && !any_masks) break;
    commands.bind(triangles_[masks]);
    for (uint32_t v = 0; v < volumes; ++v) {
      volume(v);
      lists.dispatchTriangles(commands, v, masks);
    }
  }
  commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
  commands.bind(tiles_[any_masks]);
  for (uint32_t v = 0; v < volumes; ++v) {
    volume(v);
    commands.dispatch(shared::kTileGroups);
  }
}

}  // namespace helio::render
