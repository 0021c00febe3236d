#include "render/path_queue.h"

#include <cstddef>

#include "shared/extra_samples.h"
#include "shared/paths.h"

namespace helio::render {
namespace {
constexpr shared::PathLaunch kNoPaths{0, 1, 1, 0, 1, 1};
}  // namespace

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

void PathQueue::reserveExtra(uint32_t width, uint32_t height) {
  using enum gpu::MemoryCategory;
  const auto tiles = [](uint32_t pixels) { return (pixels + shared::kExtraTile - 1) / shared::kExtraTile; };
  if (!extra_)
    extra_ = gpu::Buffer(device_, {"further paths", sizeof(shared::ExtraSamples), path_tracing, gpu::Placement::device,
                                   VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT});
  if (const uint64_t bytes = uint64_t{tiles(width)} * tiles(height) * sizeof(shared::ExtraTile);
      bytes > extra_tiles_.size())
    extra_tiles_ = gpu::Buffer(device_, {"tiles of further paths", bytes, path_tracing});
  if (const uint64_t bytes = uint64_t{width} * height * sizeof(uint32_t); bytes > extra_pixels_.size())
    extra_pixels_ = gpu::Buffer(device_, {"the list of further paths", bytes, path_tracing});
}

void PathQueue::describe(shared::FrameConstants& constants) const {
  constants.path_states = states_.address();
  constants.path_pixels = pixels_.address();
  constants.path_launches = launches_.address();
  if (!extra_) return;
  constants.extra_samples = extra_.address();
  constants.extra_tiles = extra_tiles_.address();
  constants.extra_pixels = extra_pixels_.address();
}

void PathQueue::clear(gpu::Commands& commands) const {
  const std::vector<shared::PathLaunch> none(launches_.size() / sizeof(shared::PathLaunch), kNoPaths);
  commands.upload<shared::PathLaunch>(launches_, 0, none);
}

void PathQueue::trace(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, uint32_t launch) const {
  commands.traceRaysIndirect(pipeline, launches_, launch * sizeof(shared::PathLaunch));
}

void PathQueue::dispatch(gpu::Commands& commands, uint32_t launch) const {
  commands.dispatchIndirect(launches_, launch * sizeof(shared::PathLaunch) + offsetof(shared::PathLaunch, groups));
}

void PathQueue::clearExtra(gpu::Commands& commands) const {
  shared::ExtraSamples none{};
  for (shared::PathLaunch& round : none.rounds) round = kNoPaths;
  none.listing = kNoPaths;
  commands.upload<shared::ExtraSamples>(extra_, 0, std::span(&none, 1));
}

void PathQueue::dispatchListing(gpu::Commands& commands) const {
  commands.dispatchIndirect(extra_, offsetof(shared::ExtraSamples, listing) + offsetof(shared::PathLaunch, groups));
}

void PathQueue::traceRound(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, uint32_t round) const {
  commands.traceRaysIndirect(pipeline, extra_, (round - 1) * sizeof(shared::PathLaunch));
}

void PathQueue::dispatchRound(gpu::Commands& commands, uint32_t round) const {
  commands.dispatchIndirect(extra_, (round - 1) * sizeof(shared::PathLaunch) + offsetof(shared::PathLaunch, groups));
}

}  // namespace helio::render
