// Passes `cull` and `primary_raster`: primary hits by rasterisation into the visibility image.
#pragma once

#include <array>

#include "gpu/pipelines.h"
#include "render/draw_lists.h"
#include "render/passes/compute_raster.h"
#include "render/passes/pass.h"

namespace helio::render {

/// What passes that rasterise are given beside their view.
struct RasterPass {
  const SceneResources& scene;
  const DrawTable& table;
  const accel::InstanceTable& instances;
  const CullPipelines& culling;
  effects::EffectSet effects;
};

/// What shaders that rasterise must know. A mask may need any texture coordinates and vertex colours: all effects, or
/// none but what moves vertices.
effects::EffectSet effectsOfRaster(bool masks);
/// Pipelines of one pair of shaders: for what asks no alpha mask, and for what does.
std::array<gpu::RasterPipeline, 2> rasterPipelines(gpu::Device& device, gpu::RasterDescription description);

class PrimaryRaster {
 public:
  explicit PrimaryRaster(gpu::Device& device);
  /// What an alpha mask cuts holes into is drawn behind the rest, by a pipeline of its own that asks the mask.
  void add(const ViewPass& pass, const RasterPass& raster, const glm::vec2& jitter) const;

 private:
  void draw(gpu::Commands& commands, const View& view, const glm::vec2& jitter, bool any_masks) const;
  void compute(gpu::Commands& commands, const View& view, const glm::vec2& jitter, bool any_masks) const;

  std::array<gpu::RasterPipeline, 2> pipelines_;
  ComputeRaster compute_;
  gpu::ComputePipeline resolve_;
};

}  // namespace helio::render
