#include "accel/shared_blases.h"

#include <algorithm>
#include <cstring>

namespace helio::accel {

SharedBlases::SharedBlases(gpu::Device& device, std::vector<shared::MeshRecord> records,
                           std::vector<SharedShape> shapes)
    : device_(device),
      records_(std::move(records)),
      shapes_(std::move(shapes)),
      entries_(records_.size()),
      need_(records_.size()) {
  for (uint32_t record = 0; record < shapes_.size(); ++record) {
    const SharedShape& shape = shapes_[record];
    levels_.resize(std::max<size_t>(levels_.size(), shape.mesh + 1));
    levels_[shape.mesh].push_back(record);
    if (!shape.geometries.empty())
      entries_[record].sizes = gpu::blasSizes(device_, shape.geometries, gpu::BlasKind::still);
  }
  const uint64_t bytes = records_.size() * sizeof(uint32_t);
  table_ = gpu::Buffer(device_, {"the meshes that rays meet", records_.size() * sizeof(shared::MeshRecord),
                                 gpu::MemoryCategory::ray_tracing});
  needs_ = gpu::Buffer(device_, {"which BLASes are needed", bytes, gpu::MemoryCategory::ray_tracing});
  needs_readback_ = gpu::Buffer(
      device_, {"which BLASes are needed, read back", bytes, gpu::MemoryCategory::transfer, gpu::Placement::readback});
}

uint32_t SharedBlases::recordOf(const shared::InstanceRecord& instance) const {
  return instance.level == 0 ? instance.mesh : records_[instance.mesh].coarser + instance.level - 1;
}

void SharedBlases::want(uint32_t record) { arriving_.push_back(record); }

void SharedBlases::beginTick() {
  retired_.clear();
  pending_.clear();
  copies_.clear();
  figures_ = {};
  grew_ = false;
  for (Entry& entry : entries_) entry.fresh = false;
  compactLast();
}

void SharedBlases::readNeeds() {
  // Where the TLAS stayed as it was, so did the needs.
  if (asked_) {
    needs_readback_.invalidate();
    std::memcpy(need_.data(), needs_readback_.mapped(), need_.size() * sizeof(uint32_t));
  }
  for (const uint32_t record : arriving_) need_[record] = std::max(need_[record], 1u);
  asked_ = false;
  arriving_.clear();
}

void SharedBlases::compactLast() {
  if (!query_) return;
  const std::vector<uint64_t> sizes = query_.sizes();
  query_ = {};
  for (size_t i = 0; i < sizes.size(); ++i) {
    Entry& entry = entries_[asked_sizes_[i]];
    const uint64_t size = entry.blas.size();
    if (!gpu::worthCompacting(size, sizes[i])) continue;
    gpu::AccelerationStructure compacted(device_, "the compacted BLAS of " + shapes_[asked_sizes_[i]].name,
                                         VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, sizes[i]);
    copies_.push_back({entry.blas.handle(), compacted.handle()});
    retired_.push_back(std::move(entry.blas));
    entry.blas = std::move(compacted);
    entry.saved = size - sizes[i];
    entry.fresh = dirty_ = true;
  }
}

uint32_t SharedBlases::standIn(uint32_t record) const {
  const std::vector<uint32_t>& levels = levels_[shapes_[record].mesh];
  const auto self = std::find(levels.begin(), levels.end(), record);
  for (auto finer = self;; --finer) {
    if (resident(*finer)) return *finer;
    if (finer == levels.begin()) break;
  }
  for (auto coarser = self + 1; coarser != levels.end(); ++coarser)
    if (resident(*coarser)) return *coarser;
  return record;
}

void SharedBlases::evict(uint32_t record) {
  Entry& entry = entries_[record];
  entry.blas = {};
  entry.saved = 0;
  ++figures_.evicted;
  dirty_ = true;
}

bool SharedBlases::makeRoom(uint64_t bytes, uint64_t tick) {
  std::vector<uint32_t> idle;
  uint64_t held = this->bytes(), needed = held;
  for (uint32_t record = 0; record < entries_.size(); ++record) {
    if (!resident(record) || entries_[record].used_at == tick || entries_[record].fresh) continue;
    idle.push_back(record);
    needed -= entries_[record].blas.size();
  }
  if (needed + bytes > settings_.memory) return false;
  std::sort(idle.begin(), idle.end(), [this](uint32_t a, uint32_t b) {
    return entries_[a].used_at != entries_[b].used_at ? entries_[a].used_at < entries_[b].used_at : a < b;
  });
  for (auto oldest = idle.begin(); held + bytes > settings_.memory; ++oldest) {
    held -= entries_[*oldest].blas.size();
    evict(*oldest);
  }
  return true;
}

void SharedBlases::plan(uint64_t tick, BlasBatch& batch) {
  beginTick();
  readNeeds();
  everything_ = false;
  std::vector<uint32_t> missing;
  for (uint32_t record = 0; record < entries_.size(); ++record) {
    if (need_[record] == 0 || shapes_[record].geometries.empty()) continue;
    entries_[standIn(record)].used_at = tick;
    if (!resident(record)) missing.push_back(record);
  }
  std::sort(missing.begin(), missing.end(),
            [this](uint32_t a, uint32_t b) { return need_[a] != need_[b] ? need_[a] > need_[b] : a < b; });
  for (const uint32_t record : missing) {
    const SharedShape& shape = shapes_[record];
    Entry& entry = entries_[record];
    if (!(batch.affords(shape.triangles) || batch.untouched()) || !makeRoom(entry.sizes.structure, tick)) {
      ++figures_.waiting;
      continue;
    }
    entry.blas = gpu::AccelerationStructure(device_, "the BLAS of " + shape.name,
                                            VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, entry.sizes.structure);
    entry.used_at = tick;
    entry.fresh = dirty_ = true;
    pending_.push_back(record);
    batch.spend(shape.triangles);
    batch.add({entry.blas.handle(), shape.geometries, gpu::BlasKind::still}, entry.sizes.build_scratch);
    ++figures_.built;
    grew_ = true;
    figures_.triangles += shape.triangles;
  }
  for (uint32_t record = 0; record < entries_.size(); ++record)
    if (const Entry& entry = entries_[record]; entry.blas && !entry.fresh && tick - entry.used_at > settings_.age_limit)
      evict(record);
  for (const Entry& entry : entries_) figures_.resident += static_cast<bool>(entry.blas);
}

void SharedBlases::planAll(uint64_t tick, gpu::Commands& commands) {
  beginTick();
  everything_ = true;
  asked_ = false;
  arriving_.clear();
  std::vector<gpu::BlasInput> inputs;
  std::vector<uint32_t> built;
  for (uint32_t record = 0; record < entries_.size(); ++record) {
    if (shapes_[record].geometries.empty()) continue;
    entries_[record].used_at = tick;
    ++figures_.resident;
    if (resident(record)) continue;
    inputs.push_back({shapes_[record].name, shapes_[record].geometries});
    built.push_back(record);
  }
  if (built.empty()) return;
  grew_ = true;
  commands.begin();
  std::vector<gpu::AccelerationStructure> blases = gpu::buildBlases(commands, inputs);
  commands.submit();
  (void)commands.finish();
  (void)gpu::compact(commands, blases);
  for (size_t i = 0; i < built.size(); ++i) {
    Entry& entry = entries_[built[i]];
    entry.blas = std::move(blases[i]);
    entry.saved = entry.sizes.structure - entry.blas.size();
  }
  dirty_ = true;
}

void SharedBlases::forget() {
  for (Entry& entry : entries_)
    if (entry.fresh) entry.blas = {};
  query_ = {};
  pending_.clear();
  copies_.clear();
  asked_ = false;
  dirty_ = true;
}

void SharedBlases::upload(gpu::Commands& commands) {
  if (!everything_) commands.fill(needs_, 0);
  if (!dirty_) return;
  std::vector<shared::MeshRecord> table = records_;
  for (uint32_t record = 0; record < table.size(); ++record) {
    const uint32_t coarser = table[record].coarser, stand_in = standIn(record);
    table[record] = records_[stand_in];
    table[record].coarser = coarser;
    table[record].blas = entries_[stand_in].blas.address();
  }
  commands.upload<shared::MeshRecord>(table_, 0, table);
  dirty_ = false;
}

void SharedBlases::record(gpu::Commands& commands) {
  if (!copies_.empty()) commands.barrier(gpu::use::build_write, gpu::use::build_write);
  for (const Copy& copy : copies_) gpu::copyCompacted(commands, copy.from, copy.to);
  if (pending_.empty()) return;
  std::vector<VkAccelerationStructureKHR> handles;
  for (const uint32_t record : pending_) handles.push_back(entries_[record].blas.handle());
  query_ = gpu::CompactionQuery(commands, handles);
  asked_sizes_ = pending_;
}

void SharedBlases::readBack(gpu::Commands& commands) {
  if (everything_) return;
  commands.copy(needs_, needs_readback_, needs_.size());
  commands.barrier(gpu::use::transfer_write, gpu::use::host_read);
  asked_ = true;
}

uint64_t SharedBlases::bytes() const {
  uint64_t bytes = 0;
  for (const Entry& entry : entries_) bytes += entry.blas.size();
  for (const gpu::AccelerationStructure& blas : retired_) bytes += blas.size();
  return bytes;
}

uint64_t SharedBlases::compactionSaved() const {
  uint64_t bytes = 0;
  for (const Entry& entry : entries_) bytes += entry.saved;
  return bytes;
}

}  // namespace helio::accel
