#include "accel/units.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace helio::accel {
namespace {

constexpr uint64_t kPoseChunk = 4u << 20;
constexpr uint64_t kRowBytes = 3 * sizeof(glm::vec4);  // of an affine map

/// A number in [0, 1) that belongs to an id [SplitMix64's finaliser].
double fractionOf(world::InstanceId id) {
  uint64_t z = id + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

Units::Units(gpu::Device& device, const scene::Scene& scene, const ClipTable& clips, std::vector<DeformingMesh> meshes)
    : device_(device),
      scene_(scene),
      clips_(clips),
      meshes_(std::move(meshes)),
      time_(std::numeric_limits<double>::quiet_NaN()),
      poses_pool_(device, {"the poses of units", kPoseChunk, gpu::MemoryCategory::raster}),
      move_(device, "animate/move.comp"),
      pose_(device, "animate/pose.comp") {}

void Units::apply(const world::ChangeSet& changes, const InstanceTable& table,
                  const std::function<void(uint32_t)>& on_gone) {
  if (unit_of_slot_.size() < changes.slot_count) unit_of_slot_.resize(changes.slot_count, scene::kNone);
  for (const auto& [slot, instance] : changes.slots) {
    if (const uint32_t index = unit_of_slot_[slot]; index != scene::kNone) {
      on_gone(index);
      remove(index);
    }
    const PlacedInstance& placed = table.instances()[slot];
    if (placed.prefab == scene::kNone) continue;
    if (table.travels(slot) || scene_.prefabs[placed.prefab].rig != scene::kNone || meshes_[placed.mesh].deform != 0)
      add(slot, instance);
  }
}

void Units::add(uint32_t slot, const world::Instance& instance) {
  uint32_t index = static_cast<uint32_t>(units_.size());
  if (free_.empty()) {
    units_.emplace_back();
    deforms_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  Unit& unit = units_[index];
  const scene::Prefab& prefab = scene_.prefabs[instance.prefab];
  unit = {};
  unit.slot = slot;
  unit.prefab = instance.prefab;
  unit.mesh = prefab.mesh;
  unit.home = instance.transform;
  if (const scene::Placement* placed = routedPlacement(scene_, instance)) {
    unit.route = &scene_.routes[placed->route];
    unit.route_start = static_cast<double>(placed->route_start);
    unit.route_speed = static_cast<double>(placed->route_speed);
  }
  unit.clip = unit.route ? prefab.travel_clip : prefab.clip;
  const DeformingMesh& mesh = meshes_[unit.mesh];
  deforms_[index] = {};
  deforms_[index].mesh = mesh.deform;
  deforms_[index].ground = clips_.ground();
  if (prefab.rig != scene::kNone) {
    const scene::Rig& rig = scene_.rigs[prefab.rig];
    if (prefab.out_of_step) unit.phase = fractionOf(instance.id) * static_cast<double>(rig.clips[unit.clip].duration);
    unit.posed = mesh.deform != 0;
    if (unit.posed) {
      const uint64_t nodes = rig.nodes.size() * kRowBytes, palette = rig.joints.size() * kRowBytes;
      unit.pose = poses_pool_.allocate(nodes + palette + rig.weights.size() * sizeof(float) + 16, 16);
      deforms_[index].palette = unit.pose.address + nodes;
      deforms_[index].weights = unit.pose.address + nodes + palette;
    }
  }
  unit_of_slot_[slot] = index;
  if (looks_back_) {
    unit_slots_.push_back(slot);
    keepPrevious(index);
  }
  fresh_.push_back(index);
  deforms_dirty_ = true;
  ++count_;
}

void Units::remove(uint32_t index) {
  Unit& unit = units_[index];
  unit_of_slot_[unit.slot] = scene::kNone;
  if (looks_back_) unit_slots_.push_back(unit.slot);
  poses_pool_.free(unit.pose);
  poses_pool_.free(unit.previous);
  unit = {};
  deforms_[index] = {};
  free_.push_back(index);
  --count_;
}

void Units::growTable() {
  if (const uint64_t bytes = units_.size() * sizeof(shared::MotionRecord);
      looks_back_ && motion_buffer_.size() < bytes) {
    motion_buffer_ = gpu::Buffer(device_, {"where units were", bytes * 3 / 2, gpu::MemoryCategory::path_tracing});
    all_ = true;
    moved_ = false;  // what it held is lost: in this tick nothing has moved, as far as is known
  }
  if (deform_buffer_ && deform_buffer_.size() >= units_.size() * sizeof(shared::DeformRecord)) return;
  uint64_t capacity = 256;
  while (capacity < units_.size()) capacity *= 2;
  deform_buffer_ = gpu::Buffer(
      device_, {"the table of what deforms", capacity * sizeof(shared::DeformRecord), gpu::MemoryCategory::raster});
  deforms_dirty_ = all_ = true;  // every instance record holds an address in it
}

glm::mat4x3 Units::transformAt(const Unit& unit, double time, double& clip_time) const {
  const scene::Prefab& prefab = scene_.prefabs[unit.prefab];
  const scene::Clip* clip = prefab.rig == scene::kNone ? nullptr : &scene_.rigs[prefab.rig].clips[unit.clip];
  const float duration = clip ? clip->duration : 0.0f;
  if (unit.route) {
    // The clip follows the way and not the time: feet do not slide, whatever the speed.
    const double way = unit.route_start + unit.route_speed * time;
    clip_time = scene::clipTime(unit.phase + way / static_cast<double>(prefab.travel_speed), duration);
    return unit.route->at(way);
  }
  clip_time = scene::clipTime(unit.phase + time, duration);
  if (!clip || prefab.node == scene::kNone) return unit.home;
  const auto nodes = scene::nodesAt(scene_.rigs[prefab.rig], *clip, static_cast<float>(clip_time));
  return scene::concatenate(unit.home, nodes[prefab.node]);
}

void Units::addPose(Unit& unit, double clip_time) {
  const uint32_t rig = scene_.prefabs[unit.prefab].rig;
  const uint64_t nodes = scene_.rigs[rig].nodes.size() * kRowBytes,
                 palette = scene_.rigs[rig].joints.size() * kRowBytes;
  const VkDeviceAddress previous = looks_back_ ? unit.previous.address : 0;
  poses_.push_back({clips_.clip(rig, unit.clip), unit.pose.address, unit.pose.address + nodes,
                    unit.pose.address + nodes + palette, previous, previous + palette, static_cast<float>(clip_time),
                    !unit.in_pose});
  unit.in_pose = true;
}

void Units::lookBack(bool wanted) {
  if (wanted == looks_back_) return;
  looks_back_ = wanted;
  unit_slots_.clear();
  if (wanted) {
    unit_of_slot_dirty_ = all_ = true;
    for (uint32_t index = 0; index < units_.size(); ++index) keepPrevious(index);
    return;
  }
  motion_buffer_ = {};
  unit_of_slot_buffer_ = {};
  for (uint32_t index = 0; index < units_.size(); ++index) {
    poses_pool_.free(units_[index].previous);
    units_[index].previous = {};
    deforms_[index].previous_palette = deforms_[index].previous_weights = 0;
  }
  deforms_dirty_ = true;
}

/// Room for the unit's pose of the tick before.
void Units::keepPrevious(uint32_t index) {
  Unit& unit = units_[index];
  if (unit.slot == scene::kNone || !unit.posed) return;
  const scene::Rig& rig = scene_.rigs[scene_.prefabs[unit.prefab].rig];
  const uint64_t palette = rig.joints.size() * kRowBytes;
  unit.previous = poses_pool_.allocate(palette + rig.weights.size() * sizeof(float) + 16, 16);
  deforms_[index].previous_palette = unit.previous.address;
  deforms_[index].previous_weights = unit.previous.address + palette;
  deforms_dirty_ = true;
}

void Units::describe(shared::HistoryConstants& history) const {
  history.moved = moved_;
  history.unit_of_slot = unit_of_slot_buffer_ ? unit_of_slot_buffer_.address() : 0;
  history.unit_of_slot_size = static_cast<uint32_t>(unit_of_slot_buffer_.size() / sizeof(uint32_t));
  history.motions = motion_buffer_ ? motion_buffer_.address() : 0;
}

bool Units::pose(double time, InstanceTable& table) {
  moved_slots_.clear();
  moved_units_.clear();
  poses_.clear();
  moved_ = time != time_ && !std::isnan(time_);
  if (units_.empty()) return false;
  growTable();
  const bool everything = all_ || time != time_;
  const auto bring = [&](uint32_t index) {
    Unit& unit = units_[index];
    if (unit.slot == scene::kNone) return;
    double clip_time = 0.0;
    const glm::mat4x3 transform = transformAt(unit, time, clip_time);
    const bool travels = table.travels(unit.slot);
    if (travels || all_ || !everything || table.records()[unit.slot].deform == 0) {
      const VkDeviceAddress deform =
          meshes_[unit.mesh].deform == 0 ? 0 : deform_buffer_.address() + index * sizeof(shared::DeformRecord);
      table.place(unit.slot, transform, deform);
      moved_slots_.push_back(unit.slot);
      moved_units_.push_back(index);
    }
    if (unit.posed) addPose(unit, clip_time);
  };
  bool changed = everything || !fresh_.empty();
  if (everything) {
    for (uint32_t index = 0; index < units_.size(); ++index) bring(index);
  } else {
    for (const uint32_t index : fresh_) bring(index);
  }
  // A world in which nothing moves but buildings stand fitted to the ground stands still for all that.
  if (everything && !all_ && fresh_.empty()) changed = !poses_.empty() || !moved_slots_.empty();
  fresh_.clear();
  time_ = time;
  all_ = false;
  if (!moved_slots_.empty()) table.sortTravellers();
  return changed;
}

void Units::forget() {
  all_ = deforms_dirty_ = unit_of_slot_dirty_ = true;
  for (Unit& unit : units_) unit.in_pose = false;
  time_ = std::numeric_limits<double>::quiet_NaN();
}

void Units::setBlas(uint32_t unit, VkDeviceAddress positions, uint32_t vertex_count, VkDeviceAddress blas) {
  shared::DeformRecord& record = deforms_[unit];
  if (record.positions == positions && record.vertex_count == vertex_count && record.blas == blas) return;
  record.positions = positions;
  record.vertex_count = vertex_count;
  record.blas = blas;
  deforms_dirty_ = true;
}

void Units::upload(gpu::Commands& commands, const InstanceTable& table) {
  moved_records_.clear();
  for (const uint32_t slot : moved_slots_) moved_records_.push_back(table.records()[slot]);
  if (deforms_dirty_ && !deforms_.empty()) commands.upload<shared::DeformRecord>(deform_buffer_, 0, deforms_);
  deforms_dirty_ = false;
  if (looks_back_) uploadUnitsOfSlots(commands);
  units_at_ = gpu::alignUp(moved_slots_.size() * sizeof(uint32_t), size_t{16});
  records_at_ = units_at_ * 2;
  poses_at_ = gpu::alignUp(records_at_ + moved_records_.size() * sizeof(shared::InstanceRecord), size_t{16});
  const uint64_t bytes = poses_at_ + poses_.size() * sizeof(shared::PoseRecord);
  if (tick_buffer_.size() < bytes) {
    if (tick_buffer_) commands.retire(std::move(tick_buffer_));
    tick_buffer_ = gpu::Buffer(device_, {"the moves of a tick", bytes + bytes / 2, gpu::MemoryCategory::raster});
  }
  if (!moved_slots_.empty()) {
    commands.upload(tick_buffer_, 0, std::as_bytes(std::span(moved_slots_)));
    commands.upload(tick_buffer_, units_at_, std::as_bytes(std::span(moved_units_)));
    commands.upload(tick_buffer_, records_at_, std::as_bytes(std::span(moved_records_)));
  }
  if (!poses_.empty()) commands.upload(tick_buffer_, poses_at_, std::as_bytes(std::span(poses_)));
}

void Units::uploadUnitsOfSlots(gpu::Commands& commands) {
  const uint64_t bytes = unit_of_slot_.size() * sizeof(uint32_t);
  if (unit_of_slot_buffer_.size() < bytes) {
    if (unit_of_slot_buffer_) commands.retire(std::move(unit_of_slot_buffer_));
    unit_of_slot_buffer_ =
        gpu::Buffer(device_, {"the units of slots", bytes * 3 / 2, gpu::MemoryCategory::path_tracing});
    commands.fill(unit_of_slot_buffer_, shared::kNoUnit);
    commands.barrier(gpu::use::transfer_write, gpu::use::transfer_write);
    unit_of_slot_dirty_ = true;
  }
  if (unit_of_slot_dirty_) {
    commands.upload<uint32_t>(unit_of_slot_buffer_, 0, unit_of_slot_);
  } else {
    std::sort(unit_slots_.begin(), unit_slots_.end());
    for (const uint32_t slot : unit_slots_)
      commands.upload<uint32_t>(unit_of_slot_buffer_, slot, std::span(unit_of_slot_).subspan(slot, 1));
  }
  unit_slots_.clear();
  unit_of_slot_dirty_ = false;
}

void Units::record(gpu::Commands& commands, const InstanceTable& table) {
  if (table_ != table.recordBuffer().address()) moved_ = false;  // a new table has no memory of the tick before
  table_ = table.recordBuffer().address();
  const auto groups = [](size_t threads) { return static_cast<uint32_t>((threads + 63) / 64); };
  if (!moved_slots_.empty()) {
    commands.bind(move_);
    commands.push(shared::MoveConstants{tick_buffer_.address(), tick_buffer_.address() + records_at_,
                                        table.recordBuffer().address(), tick_buffer_.address() + units_at_,
                                        looks_back_ ? motion_buffer_.address() : 0,
                                        static_cast<uint32_t>(moved_slots_.size())});
    commands.dispatch(groups(moved_slots_.size()));
  }
  if (!poses_.empty()) {
    commands.bind(pose_);
    commands.push(shared::PoseConstants{tick_buffer_.address() + poses_at_, static_cast<uint32_t>(poses_.size())});
    commands.dispatch(groups(poses_.size()));
  }
}

}  // namespace helio::accel
