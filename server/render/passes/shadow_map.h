// Passes `shadow_cull` and `shadow_map`: the sun's cascaded shadow map of a view (shared/shadow_map.h), drawn by the
// vertex work of the primary hits. The last cascade holds the whole world, for paths leave what the camera sees.
#pragma once

#include "render/passes/primary_raster.h"
#include "shared/shadow_map.h"

namespace helio::render {

/// Whether a view's sun shadows ask for the map.
inline bool usesShadowMap(const ViewSettings& settings, effects::EffectSet effects) {
  return settings.sun_shadow != SunShadow::rays && settings.mode == Mode::hybrid && effects.has(effects::Effect::sun);
}

/// Cascades for a camera: the smallest 24 m to each side and mostly before it, the last around all of `world`, between
/// them in equal ratios. `to_sun`: unit. `tile`: texels along a side.
shared::ShadowMap shadowCascades(const scene::Camera& camera, const glm::vec3& to_sun, const accel::OrderBlock& world,
                                 uint32_t tile);

class ShadowMapPass {
 public:
  explicit ShadowMapPass(gpu::Device& device);
  /// `filter`: a word a slot, 0 where rays meet the instance and the map need not have it, which `pass.hits` stands for
  /// in the graph; null: all are drawn.
  void add(const ViewPass& pass, const RasterPass& raster, const glm::vec3& to_sun, const accel::OrderBlock& world,
           const gpu::Buffer* filter = nullptr) const;

 private:
  void draw(gpu::Commands& commands, const View& view, uint32_t tile, bool any_masks) const;
  void compute(gpu::Commands& commands, const View& view, uint32_t tile, bool any_masks) const;

  std::array<gpu::RasterPipeline, 2> pipelines_;
  ComputeRaster compute_;
};

}  // namespace helio::render
