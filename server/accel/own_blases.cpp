#include "accel/own_blases.h"

#include <algorithm>

namespace helio::accel {
namespace {

constexpr uint64_t kVertexChunk = 1u << 20, kStructureChunk = 2u << 20;  // bytes
constexpr uint64_t kVertexAlignment = 16, kStructureAlignment = 256;     // the latter is what Vulkan asks for
constexpr uint32_t kMostRows = 65'535;                                   // groups along y of one dispatch

}  // namespace

OwnBlases::OwnBlases(gpu::Device& device)
    : device_(device),
      vertices_pool_(device,
                     {"deformed vertices", kVertexChunk, gpu::MemoryCategory::ray_tracing, gpu::Placement::device,
                      VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR}),
      structures_pool_(device, {"BLASes of instances' own", kStructureChunk, gpu::MemoryCategory::ray_tracing,
                                gpu::Placement::device, VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR}),
      deform_(device, "animate/deform.comp") {}

void OwnBlases::release(uint32_t unit) {
  if (unit >= structures_.size() || !structures_[unit].storage) return;
  Structure& structure = structures_[unit];
  structure.blas = {};
  structures_pool_.free(structure.storage);
  vertices_pool_.free(structure.vertices);
  structure = {};  // plan() drops it from held_
}

void OwnBlases::forget() {
  for (Structure& structure : structures_) structure.built = false;
}

void OwnBlases::plan(std::span<const WantedUnit> wanted, Units& units, InstanceTable& table, uint64_t tick, bool moved,
                     BlasBatch& batch) {
  if (structures_.size() < units.units().size()) structures_.resize(units.units().size());
  figures_ = {};
  deform_jobs_.clear();
  most_vertices_ = 0;
  for (const WantedUnit& want : wanted) structures_[want.unit].wanted_at = tick;

  std::erase_if(held_, [this](uint32_t unit) { return !structures_[unit].storage; });
  // What nobody wants leaves the TLAS now, and memory later: cameras swing back.
  std::vector<uint32_t> aged;
  for (const uint32_t unit : held_) {
    Structure& structure = structures_[unit];
    if (structure.wanted_at == tick) continue;
    structure.in_tlas = false;
    units.setBlas(unit, 0, 0, 0);
    if (tick - structure.wanted_at > kAgeLimit) aged.push_back(unit);
  }
  for (const uint32_t unit : aged) release(unit);
  std::erase_if(held_, [this](uint32_t unit) { return !structures_[unit].storage; });

  for (const WantedUnit& want : wanted) {
    const uint32_t unit = want.unit, level = want.level;
    const DeformingMesh& mesh = units.meshOf(unit);
    Structure& structure = structures_[unit];
    const bool posed = units.units()[unit].posed;
    const bool in_turn = posed && moved && (unit + tick) % kRebuildEvery == 0;
    const auto affordable = [&](uint32_t at) { return batch.affords(mesh.levels[at].triangles); };
    // It was out of the TLAS for a while, or never in it: its pose is old, and a build is due.
    bool build = !structure.built || (posed && !structure.in_tlas);
    if (build && !affordable(level)) {
      ++figures_.waiting;
      structure.in_tlas = false;
      units.setBlas(unit, 0, 0, 0);
      continue;
    }
    if (structure.level != level && affordable(level)) {
      const uint64_t wanted_at = structure.wanted_at;
      release(unit);
      structure.level = level;
      structure.wanted_at = wanted_at;
      build = true;
    }
    const DeformingLevel& shape = mesh.levels[structure.level];
    if (build) batch.spend(shape.triangles);
    const auto enter = [&] {
      structure.built = structure.in_tlas = true;
      units.setBlas(unit, structure.vertices.address, shape.vertex_count, structure.blas.address());
      table.setLevel(units.units()[unit].slot, structure.level);
      ++figures_.in_tlas;
    };
    if (!build && (!moved || !posed)) {
      enter();
      continue;
    }
    bool placed = false;
    if (!structure.storage) {
      structure.vertices = vertices_pool_.allocate(uint64_t{shape.vertex_count} * sizeof(glm::vec3), kVertexAlignment);
      structure.storage = structures_pool_.allocate(shape.sizes.structure, kStructureAlignment);
      held_.push_back(unit);
      placed = true;
    } else if (in_turn) {  // what is written anew may as well move: chunks where many were and few are come back
      (void)vertices_pool_.moveForward(structure.vertices, kVertexAlignment);
      placed = structures_pool_.moveForward(structure.storage, kStructureAlignment);
    }
    if (placed)
      structure.blas = gpu::AccelerationStructure(device_, "the BLAS of a unit",
                                                  VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, structure.storage);
    const bool refit = !build && !in_turn;
    deform_jobs_.push_back({mesh.rest, structure.vertices.address, units.units()[unit].slot, shape.vertex_count});
    gpu::BlasUpdate update{structure.blas.handle(), shape.geometries, gpu::BlasKind::moving, refit};
    for (gpu::BlasGeometry& geometry : update.geometries) geometry.positions = structure.vertices.address;
    batch.add(std::move(update), refit ? shape.sizes.refit_scratch : shape.sizes.build_scratch);
    most_vertices_ = std::max(most_vertices_, shape.vertex_count);
    enter();
    ++(refit ? figures_.refitted : figures_.built);
    figures_.triangles += shape.triangles;
  }
  // A unit that gave its BLAS back and got another one stands there twice.
  std::sort(held_.begin(), held_.end());
  held_.erase(std::unique(held_.begin(), held_.end()), held_.end());
}

void OwnBlases::upload(gpu::Commands& commands) {
  if (deform_jobs_.empty()) return;
  const uint64_t bytes = deform_jobs_.size() * sizeof(shared::DeformJob);
  if (job_buffer_.size() < bytes) {
    if (job_buffer_) commands.retire(std::move(job_buffer_));
    job_buffer_ = gpu::Buffer(device_, {"what is deformed", bytes + bytes / 2, gpu::MemoryCategory::ray_tracing});
  }
  commands.upload<shared::DeformJob>(job_buffer_, 0, deform_jobs_);
}

void OwnBlases::deform(gpu::Commands& commands, const InstanceTable& table) const {
  commands.bind(deform_);
  for (size_t first = 0; first < deform_jobs_.size(); first += kMostRows) {
    const auto rows = static_cast<uint32_t>(std::min<size_t>(kMostRows, deform_jobs_.size() - first));
    commands.push(shared::DeformConstants{job_buffer_.address() + first * sizeof(shared::DeformJob),
                                          table.recordBuffer().address()});
    commands.dispatch((most_vertices_ + 63) / 64, rows);
  }
}

}  // namespace helio::accel
