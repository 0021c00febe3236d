// Rasterising in compute shaders (shaders/raster), for passes `primary_raster` and `shadow_map`: GPUs for data centres
// have a few units for graphics and a hundred for computing.
#pragma once

#include <array>

#include "effects/registry.h"
#include "gpu/pipelines.h"
#include "render/draw_lists.h"
#include "shared/raster.h"

namespace helio::render {

/// What is drawn into.
enum class RasterTarget { picture, shadow_map };

class ComputeRaster {
 public:
  ComputeRaster(gpu::Device& device, RasterTarget target);

  /// How passes touch the lists that they draw. What they draw into they touch as DrawLists::kWrite.
  static constexpr gpu::Use kDraw{VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                  VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_SHADER_READ_BIT};

  /// Records the draws of all volumes of `lists` into what `constants` tells: frame, what is drawn into, its size, the
  /// jitter. Volumes are cascades of a shadow map. `parts`: working memory, of workingBytes().
  void draw(gpu::Commands& commands, const DrawLists& lists, uint32_t volumes, bool any_masks, const gpu::Buffer& parts,
            shared::RasterConstants constants) const;

  /// With room for so many parts of large triangles: tiles that they touch.
  static uint64_t workingBytes(uint32_t volumes, uint32_t width, uint32_t height, uint64_t room);

 private:
  std::array<gpu::ComputePipeline, 2> triangles_, spread_, tiles_;  // of what asks no mask; of what does
  gpu::ComputePipeline ends_, sort_;
};

}  // namespace helio::render
