// The memory in which paths rest between two launches of the path tracer (shaders/shared/paths.h), and the list of
// pixels that get further paths in a tick (shaders/shared/extra_samples.h). Working memory: the views of a world take
// turns with it.
#pragma once

#include "gpu/commands.h"
#include "gpu/pipelines.h"
#include "shared/frame.h"

namespace helio::render {

class PathQueue {
 public:
  explicit PathQueue(gpu::Device& device) : device_(device) {}

  /// What launches, and the passes between them, do to it.
  static constexpr gpu::Use kUse{
      gpu::use::ray_write.stages | gpu::use::compute_write.stages | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT |
          VK_PIPELINE_STAGE_2_TRANSFER_BIT,
      gpu::use::ray_write.access | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};

  /// Room for the paths of `pixels` pixels in up to `launches` launches. What it held is lost.
  void reserve(uint64_t pixels, uint32_t launches);
  /// Room for the list of pixels that get further paths.
  void reserveExtra(uint32_t width, uint32_t height);
  void describe(shared::FrameConstants& constants) const;
  uint64_t bytes() const { return states_.size() + pixels_.size() + launches_.size() + extraBytes(); }
  /// Of that, what further paths alone call for.
  uint64_t extraBytes() const { return extra_.size() + extra_tiles_.size() + extra_pixels_.size(); }

  /// Empties the queue, ahead of a sample.
  void clear(gpu::Commands& commands) const;
  /// Traces `pipeline` over the paths of `launch` (> 0).
  void trace(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, uint32_t launch) const;
  /// Dispatches what is bound over the paths of `launch` (> 0), in groups of shared::kPathGroup.
  void dispatch(gpu::Commands& commands, uint32_t launch) const;

  // ---- Further paths: round r is of the pixels that get r of them, or more, [1, kMostExtraPaths] ----
  /// Nobody gets any.
  void clearExtra(gpu::Commands& commands) const;
  /// Dispatches what is bound over the picture, if there is anything to list.
  void dispatchListing(gpu::Commands& commands) const;
  void traceRound(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, uint32_t round) const;
  void dispatchRound(gpu::Commands& commands, uint32_t round) const;

 private:
  gpu::Device& device_;
  gpu::Buffer states_, pixels_, launches_;
  gpu::Buffer extra_, extra_tiles_, extra_pixels_;
};

}  // namespace helio::render
