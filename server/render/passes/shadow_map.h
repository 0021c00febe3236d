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

/// Whom a shadow map draws.
struct ShadowCasters {
  const gpu::Buffer* table = nullptr;  ///< uint, by slot: 0 where the map need not have the instance; null: all
  Resource written_with = nullptr;     ///< what stands for the table in the graph
};

class ShadowMapPass {
 public:
  explicit ShadowMapPass(gpu::Device& device);
  void add(const ViewPass& pass, const RasterPass& raster, const glm::vec3& to_sun, const accel::OrderBlock& world,
           const ShadowCasters& only) const;

 private:
  void draw(gpu::Commands& commands, const View& view, uint32_t tile, bool any_masks) const;
  void compute(gpu::Commands& commands, const View& view, uint32_t tile, bool any_masks) const;

  std::array<gpu::RasterPipeline, 2> pipelines_;
  ComputeRaster compute_;
  gpu::ComputePipeline clear_;
};

}  // namespace helio::render
