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

  /// Room for the paths of `pixels` pixels in up to `launches` launches. What it held is lost.
  void reserve(uint64_t pixels, uint32_t launches);
  void describe(shared::FrameConstants& constants) const;
  uint64_t bytes() const { return states_.size() + pixels_.size() + launches_.size(); }

  /// Empties the queue, ahead of a sample.
  void clear(gpu::Commands& commands) const;
  /// Traces `pipeline` over the paths of `launch` (> 0).
  void trace(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, uint32_t launch) const;
  /// Dispatches what is bound over the paths of `launch` (> 0), in groups of shared::kPathGroup.
  void dispatch(gpu::Commands& commands, uint32_t launch) const;

 private:
  gpu::Device& device_;
  gpu::Buffer states_, pixels_, launches_;
};

}  // namespace helio::render
