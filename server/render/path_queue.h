// The memory in which paths rest between two launches of the path tracer (shaders/shared/paths.h). Working memory: the
// views of a world take turns with it.
#pragma once

#include "gpu/commands.h"
#include "gpu/pipelines.h"
#include "shared/frame.h"

namespace helio::render {

class PathQueue {
 public:
  explicit PathQueue(gpu::Device& device) : device_(device) {}

  /// Room for a view of `pixels` pixels whose paths have up to `vertices` vertices. What it held is lost.
  void reserve(uint64_t pixels, uint32_t vertices);
  void describe(shared::FrameConstants& constants) const;

  /// Empties the queue, ahead of a sample.
  void clear(gpu::Commands& commands) const;
  /// Launches `pipeline` over the paths that reach `vertex` (> 0).
  void trace(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, uint32_t vertex) const;
  /// Dispatches what is bound over the paths that reach `vertex` (> 0), in groups of shared::kPathGroup.
  void dispatch(gpu::Commands& commands, uint32_t vertex) const;

 private:
  gpu::Device& device_;
  gpu::Buffer states_, pixels_, launches_;
};

}  // namespace helio::render
