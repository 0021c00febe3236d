#include "render/emitter_instances.h"

#include <numeric>

#include "effects/emitters.h"

namespace helio::render {

void EmitterInstances::upload(gpu::Commands& commands, const accel::InstanceTable& instances) {
  std::vector<uint32_t> slots;
  std::vector<float> weights;
  for (uint32_t slot : instances.order()) {
    const float weight = instances.records()[slot].emitter_weight;
    if (!(weight > 0.0f)) continue;
    slots.push_back(slot);
    weights.push_back(weight);
  }
  count_ = static_cast<uint32_t>(slots.size());
  weight_sum_ = static_cast<float>(std::accumulate(weights.begin(), weights.end(), 0.0));
  if (slots.empty()) return;

  const effects::AliasTable table = effects::makeAliasTable(weights);
  std::vector<shared::EmitterInstance> entries(slots.size());
  for (size_t i = 0; i < slots.size(); ++i) entries[i] = {slots[i], table.alias[i], table.keep[i]};
  const uint64_t bytes = entries.size() * sizeof(shared::EmitterInstance);
  if (buffer_.size() < bytes) {
    if (buffer_) commands.retire(std::move(buffer_));
    buffer_ = gpu::Buffer(device_, {"the emissive instances", bytes + bytes / 2, gpu::MemoryCategory::path_tracing});
  }
  commands.upload<shared::EmitterInstance>(buffer_, 0, entries);
}

}  // namespace helio::render
