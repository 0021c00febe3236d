#include "render/emitter_instances.h"

#include <numeric>

#include "effects/emitters.h"
#include "effects/light_grid.h"
#include "effects/punctual.h"

namespace helio::render {

void EmitterInstances::upload(gpu::Commands& commands, const accel::InstanceTable& instances) {
  made_ = true;
  ++version_;
  std::vector<effects::PlacedLight> lights = effects::placedLights(punctual_);
  const std::vector<shared::PunctualRecord> punctual = effects::punctualRecords(punctual_);
  std::vector<float> weights;
  distant_irradiance_ = 0.0f;
  for (const effects::PlacedLight& light : lights) {
    weights.push_back(punctual[light.slot & ~shared::kPunctualLight].weight);
    if (light.distant) distant_irradiance_ += light.weight;
  }
  for (uint32_t slot : instances.order()) {
    const float weight = instances.records()[slot].emitter_weight;
    if (!(weight > 0.0f)) continue;
    lights.push_back({slot, instances.instances()[slot].centre, weight});
    weights.push_back(weight);
  }
  count_ = static_cast<uint32_t>(lights.size());
  weight_sum_ = static_cast<float>(std::accumulate(weights.begin(), weights.end(), 0.0));
  const effects::LightGrid grid = effects::makeLightGrid(lights);
  grid_origin_ = grid.origin;
  grid_size_ = grid.size;
  cells_per_metre_ = grid.cells_per_metre;
  if (lights.empty()) return;

  const effects::AliasTable table = effects::makeAliasTable(weights);
  std::vector<shared::EmitterInstance> entries(lights.size());
  for (size_t i = 0; i < lights.size(); ++i) entries[i] = {lights[i].slot, table.alias[i], table.keep[i]};
  store(commands, instances_, "the emissive instances", std::as_bytes(std::span(entries)));
  store(commands, punctual_records_, "the punctual lights", std::as_bytes(std::span(punctual)));
  store(commands, cells_, "the light grid", std::as_bytes(std::span(grid.cells)));
}

void EmitterInstances::describe(shared::FrameConstants& constants) const {
  constants.emitter_instances = instances_.address();
  constants.emitter_instance_count = count_;
  constants.emitter_weight_sum = weight_sum_;
  constants.light_cells = cells_.address();
  constants.punctual_lights = punctual_records_.address();
  constants.distant_irradiance = distant_irradiance_;
  constants.light_grid_origin = grid_origin_;
  constants.light_grid_size = grid_size_;
  constants.light_cells_per_metre = cells_per_metre_;
}

void EmitterInstances::store(gpu::Commands& commands, gpu::Buffer& buffer, const std::string& name,
                             std::span<const std::byte> bytes) const {
  if (bytes.empty()) return;
  if (buffer.size() < bytes.size()) {
    if (buffer) commands.retire(std::move(buffer));
    buffer = gpu::Buffer(device_, {name, bytes.size() + bytes.size() / 2, gpu::MemoryCategory::path_tracing});
  }
  commands.upload(buffer, 0, bytes);
}

}  // namespace helio::render
