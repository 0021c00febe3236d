#include "render/path_queue.h"

#include "shared/paths.h"

namespace helio::render {

void PathQueue::reserve(uint64_t pixels, uint32_t launches) {
  using enum gpu::MemoryCategory;
  if (const uint64_t bytes = pixels * sizeof(shared::PathState); bytes > states_.size())
    states_ = gpu::Buffer(device_, {"the queue of paths", bytes, path_tracing});
  if (const uint64_t bytes = 2 * pixels * sizeof(uint32_t); bytes > pixels_.size())
    pixels_ = gpu::Buffer(device_, {"the lists of paths", bytes, path_tracing});
  if (const uint64_t bytes = launches * sizeof(shared::PathLaunch); bytes > launches_.size())
    launches_ = gpu::Buffer(device_, {"the launches of paths", bytes, path_tracing, gpu::Placement::device,
                                      VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT});
}

void PathQueue::describe(shared::FrameConstants& constants) const {
  constants.path_states = states_.address();
  constants.path_pixels = pixels_.address();
  constants.path_launches = launches_.address();
}

void PathQueue::clear(gpu::Commands& commands) const {
  const std::vector<shared::PathLaunch> none(launches_.size() / sizeof(shared::PathLaunch), {0, 1, 1, 0, 1, 1});
  commands.upload<shared::PathLaunch>(launches_, 0, none);
}

void PathQueue::trace(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, uint32_t launch) const {
  commands.traceRaysIndirect(pipeline, launches_, launch * sizeof(shared::PathLaunch));
}

void PathQueue::dispatch(gpu::Commands& commands, uint32_t launch) const {
  commands.dispatchIndirect(launches_, launch * sizeof(shared::PathLaunch) + offsetof(shared::PathLaunch, groups));
}

}  // namespace helio::render
