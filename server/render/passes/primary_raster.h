// Pass `primary_raster`: primary hits by rasterisation into the visibility image.
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/draw_list.h"
#include "render/passes/pass.h"
#include "render/scene_resources.h"

namespace helio::render {

class PrimaryRaster {
 public:
  explicit PrimaryRaster(gpu::Device& device);
  /// Adds `draw_list` (the slots' upload) and `primary_raster`. `list` must live until the graph is recorded.
  /// What an alpha mask cuts holes into is drawn behind the rest, by a pipeline of its own that asks the mask.
  void add(const ViewPass& pass, const DrawList& list, const SceneResources& scene, const glm::vec2& jitter,
           effects::EffectSet effects) const;
  /// Triangles that `list` makes the rasteriser draw.
  static uint64_t triangles(const DrawList& list, const SceneResources& scene);

 private:
  gpu::Device& device_;
  std::array<gpu::RasterPipeline, 2> pipelines_;  // without and with alpha masks
};

}  // namespace helio::render
