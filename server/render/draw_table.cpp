#include "render/draw_table.h"

#include <algorithm>
#include <numeric>

namespace helio::render {

void DrawTable::upload(gpu::Commands& commands, const accel::InstanceTable& table) {
  // Counting sort.
  const std::vector<accel::PlacedInstance>& placed = table.instances();
  std::fill(mesh_first_.begin(), mesh_first_.end(), 0u);
  for (const accel::PlacedInstance& instance : placed)
    if (instance.prefab != scene::kNone) ++mesh_first_[instance.mesh + 1];
  std::partial_sum(mesh_first_.begin(), mesh_first_.end(), mesh_first_.begin());
  by_mesh_.resize(mesh_first_.back());
  std::vector<uint32_t> next(mesh_first_.begin(), mesh_first_.end() - 1);
  for (uint32_t slot = 0; slot < placed.size(); ++slot)
    if (placed[slot].prefab != scene::kNone) by_mesh_[next[placed[slot].mesh]++] = slot;

  const auto store = [&](gpu::Buffer& buffer, const char* name, const std::vector<uint32_t>& words) {
    const uint64_t bytes = words.size() * sizeof(uint32_t);
    if (!buffer || buffer.size() < bytes || buffer.size() > 4 * bytes + 65'536) {
      if (buffer) commands.retire(std::move(buffer));
      buffer = gpu::Buffer(device_, {name, bytes + bytes / 4, gpu::MemoryCategory::raster});
    }
    commands.upload<uint32_t>(buffer, 0, words);
  };
  store(slots_buffer_, "instances by mesh", by_mesh_);
  store(first_buffer_, "the first instance of each mesh", mesh_first_);
  dirty_ = false;
}

void DrawTable::release(gpu::Commands& commands) {
  for (gpu::Buffer* buffer : {&slots_buffer_, &first_buffer_})
    if (*buffer) commands.retire(std::move(*buffer));
}

}  // namespace helio::render
