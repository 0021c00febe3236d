// What the rasteriser draws: the GPU culls a world's instances to volumes, chooses their levels of detail, and writes
// the draw commands (shaders/cull).
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gpu/pipelines.h"
#include "render/draw_table.h"
#include "render/scene_resources.h"
#include "shared/draw.h"
#include "shared/raster.h"

namespace helio::render {

/// The pipelines of culling, shared by all worlds.
struct CullPipelines {
  explicit CullPipelines(gpu::Device& device)
      : mark(device, "cull/mark.comp"),
        scan(device, "cull/scan.comp"),
        list(device, "cull/list.comp"),
        commands(device, "cull/commands.comp") {}
  gpu::ComputePipeline mark, scan, list, commands;
};

/// The draws of some volumes at once, a view's camera or a shadow map's cascades.
class DrawLists {
 public:
  /// How passes touch the lists.
  static constexpr gpu::Use kWrite{
      VK_PIPELINE_STAGE_2_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
      VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT};
  static constexpr gpu::Use kDraw{VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                                  VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_SHADER_READ_BIT};

  /// Records culling (kWrite). `filter`: a word a slot, 0 where the instance is not drawn; address 0: all may be. Grows
  /// the buffers if need be.
  void cull(gpu::Commands& commands, const CullPipelines& pipelines, const SceneResources& scene,
            const DrawTable& table, const accel::InstanceTable& instances, std::span<const shared::DrawVolume> volumes,
            VkDeviceAddress filter = 0);
  /// Records the draws of one volume (kDraw), those whose fragments ask a mask or those that do not. `constants` must
  /// hold what is not of the lists; it is pushed.
  void draw(gpu::Commands& commands, uint32_t volume, bool masks, shared::DrawConstants constants) const;
  /// What shaders/raster is told of the draws of one volume.
  void describe(uint32_t volume, shared::RasterConstants& constants) const;
  /// Records a group of threads for each shared::kTriangleGroup of its triangles (ComputeRaster::kDraw).
  void dispatchTriangles(gpu::Commands& commands, uint32_t volume, bool masks) const;
  /// Records the copy of what triangles() then tells (transfer read of the lists).
  void readBack(gpu::Commands& commands) const;
  /// Drawn for all volumes, of the last readBack() that is done.
  uint64_t triangles() const;
  uint64_t bytes() const { return work_.size() + commands_.size(); }

 private:
  void reserve(gpu::Commands& commands, uint64_t work_bytes, uint64_t command_bytes);

  gpu::Buffer volumes_, work_, commands_, counts_readback_;
  const gpu::Buffer* indices_ = nullptr;  // the scene's
  uint32_t volume_count_ = 0, draws_ = 0, solid_draws_ = 0;
  VkDeviceAddress slots_ = 0, records_ = 0;
  uint64_t slot_bytes_ = 0;  // of a volume
  uint64_t counts_at_ = 0;   // in commands_
};

/// The planes that a camera sees between, and the levels that differ from the finest by `pixels` at most; 0: the
/// finest.
shared::DrawVolume cameraVolume(const scene::Camera& camera, uint32_t width, uint32_t height, float pixels);

}  // namespace helio::render
