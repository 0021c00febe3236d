#include "render/passes/compute_raster.h"

#include <algorithm>

#include "render/passes/primary_raster.h"

namespace helio::render {
namespace {

constexpr size_t kShadowMapConstant = 60;
constexpr uint32_t kGroupsPerRow = 32'768;

uint32_t tilesOfAVolume(uint32_t width, uint32_t height) {
  const auto across = [](uint32_t pixels) { return (pixels + (1u << shared::kTileBits) - 1) >> shared::kTileBits; };
  return across(width) * across(height);
}
uint64_t mostShares(uint64_t tiles, uint64_t parts) { return tiles + parts / shared::kShareParts; }

}  // namespace

ComputeRaster::ComputeRaster(gpu::Device& device, RasterTarget target) {
  for (const bool masks : {false, true}) {
    gpu::Specialisation constants = effects::specialisation(effectsOfRaster(masks));
    constants.resize(kShadowMapConstant + 1);
    constants[kShadowMapConstant] = target == RasterTarget::shadow_map;
    triangles_[masks] = gpu::ComputePipeline(device, "raster/triangles.comp", constants);
    spread_[masks] = gpu::ComputePipeline(device, "raster/spread.comp", constants);
    tiles_[masks] = gpu::ComputePipeline(device, "raster/tiles.comp", constants);
    if (masks) continue;
    ends_ = gpu::ComputePipeline(device, "raster/ends.comp", constants);
    sort_ = gpu::ComputePipeline(device, "raster/sort.comp", constants);
  }
}

uint64_t ComputeRaster::workingBytes(uint32_t volumes, uint32_t width, uint32_t height, uint64_t room) {
  const uint64_t tiles = uint64_t{volumes} * tilesOfAVolume(width, height);
  return shared::kRasterCountsBytes + shared::kRasterTileBytes * tiles +
         shared::kRasterShareBytes * mostShares(tiles, room) + shared::kRasterPartBytes * room;
}

void ComputeRaster::draw(gpu::Commands& commands, const DrawLists& lists, uint32_t volumes, bool any_masks,
                         const gpu::Buffer& parts, shared::RasterConstants constants) const {
  const uint32_t tiles = volumes * tilesOfAVolume(constants.width, constants.height);
  const uint64_t head = workingBytes(volumes, constants.width, constants.height, 0);
  constexpr uint64_t kShare = shared::kShareParts;  // so many parts need an entry together
  constants.parts = parts.address();
  constants.part_capacity = static_cast<uint32_t>((parts.size() - head) * kShare /
                                                  (shared::kRasterPartBytes * kShare + shared::kRasterShareBytes));
  vkCmdFillBuffer(commands.handle(), parts.handle(), 0, shared::kRasterCountsBytes + 4ul * tiles, 0);
  commands.barrier(DrawLists::kWrite, gpu::use::compute_write);  // what cleared the target too
  const auto eachVolume = [&](auto&& record) {
    for (uint32_t v = 0; v < volumes; ++v) {
      lists.describe(v, constants);
      constants.cascade = v;
      commands.push(constants);
      record(v);
    }
  };
  for (const bool masks : {false, true}) {
    if (masks && !any_masks) break;
    commands.bind(triangles_[masks]);
    eachVolume([&](uint32_t v) { lists.dispatchTriangles(commands, v, masks); });
  }
  commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
  commands.bind(spread_[any_masks]);
  // No more groups than there is room for triangles: small pictures on CPUs notice.
  const uint32_t spread = std::min(shared::kSpreadGroups, constants.part_capacity / volumes / shared::kFewTiles + 1);
  eachVolume([&](uint32_t) { commands.dispatch(spread); });
  commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
  commands.bind(ends_);
  commands.dispatch(1);
  commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
  commands.bind(sort_);
  commands.dispatch(std::min(shared::kSortGroups, constants.part_capacity / shared::kSortGroup + 1));
  commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
  commands.bind(tiles_[any_masks]);
  const auto shares = static_cast<uint32_t>(mostShares(tiles, constants.part_capacity));
  const uint32_t row = std::min(shares, kGroupsPerRow);
  eachVolume([&](uint32_t) { commands.dispatch(row, (shares + row - 1) / row); });
}

}  // namespace helio::render
