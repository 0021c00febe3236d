#include "render/light_lists.h"

#include <algorithm>
#include <utility>

namespace helio::render {
namespace {

/// Pixels whose shadow rays tell of lamps, at most: more would only wait for each other at the counters.
constexpr uint64_t kTellingPixels = 65'536;

}  // namespace

bool LightLists::fit(gpu::Commands& commands, const EmitterInstances& emitters) {
  const auto reserve = [&](gpu::Buffer& buffer, const char* name, uint64_t cell_bytes) {
    const uint64_t bytes = std::max<uint64_t>(emitters.cells(), 1) * cell_bytes;
    if (buffer.size() >= bytes) return;
    if (buffer) commands.retire(std::move(buffer));
    buffer = gpu::Buffer(device_, {name, bytes, gpu::MemoryCategory::path_tracing});
  };
  reserve(learned_, "the light grid, as it was learned", sizeof(shared::LightCell));
  reserve(memories_, "what cells know of their lamps", sizeof(shared::LightMemory));
  return std::exchange(version_, emitters.version()) != emitters.version();
}

shared::LightListConstants LightLists::constants(const EmitterInstances& emitters, bool reset) const {
  return {emitters.cellTable(), learned_.address(), memories_.address(), emitters.cells(), reset};
}

void LightLists::describe(shared::FrameConstants& constants) const {
  constants.light_cells = learned_.address();
  constants.light_memory = memories_.address();
  const uint64_t pixels = uint64_t{constants.width} * constants.height;
  constants.light_note_stride = static_cast<uint32_t>((pixels + kTellingPixels - 1) / kTellingPixels);
}

}  // namespace helio::render
