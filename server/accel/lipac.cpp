#include "accel/lipac.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

namespace helio::accel {
namespace {

using shared::LipacCommand;
using shared::LipacStatus;

constexpr double kMargin = 512.0;       // metres around the scene that users build in
constexpr uint32_t kFirstGuess = 4096;  // entries, before any are known

constexpr uint64_t kCommandsAt = gpu::alignUp(sizeof(LipacStatus), 16);

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

uint32_t powerAbove(uint32_t count, uint32_t least) {
  while (least < count) least *= 2;
  return least;
}

uint32_t groups(uint32_t threads) { return (threads + shared::kLipacGroup - 1) / shared::kLipacGroup; }

/// States were counted in that tick: there was a feedback.
bool isCounted(const LipacStatus& status) {
  return std::any_of(std::begin(status.states), std::end(status.states), [](uint32_t count) { return count > 0; });
}

/// In the counters' unit.
uint32_t threshold(float hits) {
  if (!(hits <= LipacSettings::kHighestThreshold)) return shared::kNever;
  return std::max(1u, static_cast<uint32_t>(std::lround(hits * static_cast<float>(shared::kHitUnit))));
}

}  // namespace

LipacGrid gridOf(const scene::Scene& scene) {
  glm::dvec2 low(0.0), high(0.0);
  for (size_t i = 0; i < scene.placements.size(); ++i) {
    const glm::vec3 place = scene.placements[i].transform[3];
    const glm::dvec2 at(place.x, place.z);
    low = i == 0 ? at : glm::min(low, at);
    high = i == 0 ? at : glm::max(high, at);
  }
  constexpr double kBlock = shared::kCellMetres << shared::kBlockBits;  // metres
  const auto blocks = [](double extent) {
    return static_cast<uint32_t>(std::min(std::ceil((extent + 2.0 * kMargin) / kBlock), 1.0 * shared::kGridBlocksMost));
  };
  LipacGrid grid;
  grid.blocks_x = blocks(high.x - low.x);
  grid.blocks_z = blocks(high.y - low.y);
  const glm::dvec2 corner = 0.5 * (low + high) - 0.5 * kBlock * glm::dvec2(grid.blocks_x, grid.blocks_z);
  grid.x = static_cast<int32_t>(std::floor(corner.x / shared::kCellMetres));
  grid.z = static_cast<int32_t>(std::floor(corner.y / shared::kCellMetres));
  return grid;
}

// As placedOf() in lib/lipac_instance.glsl.
bool exceedsHitbox(const shared::InstanceRecord& instance, const scene::Aabb& mesh_bounds) {
  const glm::vec3 half_extent = 0.5f * mesh_bounds.extent();
  const auto reach = [&](int row) { return glm::dot(glm::abs(glm::vec3(instance.rows[row])), half_extent); };
  return std::max(reach(0), reach(2)) > static_cast<float>(shared::kCellMetres);
}

Lipac::Lipac(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene, const LipacSettings& settings)
    : device_(device),
      settings_(settings),
      grid_(gridOf(scene)),
      patch_(device, "lipac/patch.comp"),
      reset_(device, "lipac/reset.comp"),
      appear_(device, "lipac/appear.comp"),
      classify_(device, "lipac/classify.comp"),
      count_boxes_(device, "lipac/count_boxes.comp"),
      count_entries_(device, "lipac/count_entries.comp"),
      offsets_(device, "lipac/offsets.comp"),
      emit_(device, "lipac/emit.comp"),
      emit_boxes_(device, "lipac/emit_boxes.comp"),
      gather_(device, "lipac/gather.comp"),
      decide_hitboxes_(device, "lipac/hitboxes.comp"),
      decide_(device, "lipac/decide.comp"),
      appearance_(settings) {
  using enum gpu::MemoryCategory;
  std::vector<shared::MeshBounds> bounds;
  for (const scene::Mesh& mesh : scene.meshes) bounds.push_back({mesh.bounds.centre(), 0.5f * mesh.bounds.extent()});
  bounds_ = gpu::Buffer(device, {"bounds of meshes", bounds.size() * sizeof(shared::MeshBounds), ray_tracing});
  hitboxes_ = gpu::Buffer(device, {"the hitboxes", grid_.cells() * sizeof(shared::Hitbox), ray_tracing});
  reaches_ = gpu::Buffer(device, {"the reach of hitboxes", grid_.cells() * sizeof(uint32_t), ray_tracing});
  box_sums_ = gpu::Buffer(device, {"sums of hitboxes", groups(grid_.cells()) * sizeof(uint32_t), ray_tracing});
  tick_buffer_ = gpu::Buffer(device, {"the constants of culling", sizeof(shared::LipacTick), ray_tracing});

  // The unit cube that stands for what is culled.
  std::vector<glm::vec3> corners;
  for (uint32_t i = 0; i < 8; ++i) corners.emplace_back(i & 1u, i >> 1 & 1u, i >> 2);
  const std::vector<uint32_t> triangles = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                           2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  constexpr VkBufferUsageFlags kInput = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
  cube_positions_ = gpu::Buffer(
      device, {"the cube's corners", corners.size() * sizeof(glm::vec3), ray_tracing, gpu::Placement::device, kInput});
  cube_indices_ = gpu::Buffer(device, {"the cube's triangles", triangles.size() * sizeof(uint32_t), ray_tracing,
                                       gpu::Placement::device, kInput});
  commands.begin();
  commands.upload<shared::MeshBounds>(bounds_, 0, bounds);
  commands.upload<glm::vec3>(cube_positions_, 0, corners);
  commands.upload<uint32_t>(cube_indices_, 0, triangles);
  commands.barrier(gpu::use::transfer_write, gpu::use::build_read);
  const gpu::BlasInput cube{
      "the unit cube",
      {{cube_positions_.address(), 8, cube_indices_.address(), static_cast<uint32_t>(triangles.size() / 3), true}}};
  cube_ = std::move(gpu::buildBlases(commands, {&cube, 1}).front());
  commands.submit();
  (void)commands.finish();
}

void Lipac::noteEdits(const world::ChangeSet& changes, const InstanceTable& table) {
  figures_.cpu_visits = changes.slots.size();
  for (const auto& [slot, instance] : changes.slots) {
    edited_.push_back(slot);
    const uint32_t before = slot < table.instances().size() ? table.instances()[slot].prefab : scene::kNone;
    if (before == scene::kNone || before == instance.prefab) continue;
    patches_.push_back({slot, shared::kPatchReset});
    granted_.erase(slot);
  }
}

LipacStatus Lipac::statusIn(const Returned& returned) const {
  returned.buffer.invalidate();
  LipacStatus status;
  std::memcpy(&status, returned.buffer.mapped(), sizeof status);
  return status;
}

void Lipac::readCommands() {
  asked_.clear();
  if (const Returned& returned = returned_[ticks_ % kDelay]; returned.written) {
    const LipacStatus status = statusIn(returned);
    // Those that wanted in then, and those whose states have called for it since.
    const uint32_t called = status.states[shared::kStateOmitted] + status.states[shared::kStateRequested] +
                            status.states[shared::kStateActive];
    if (isCounted(status)) std::copy(std::begin(status.states), std::end(status.states), states_known_.begin());
    room_known_.surfaces = std::max(status.wanted, called);
    room_known_.counted = status.boxes + room_known_.surfaces;
    const auto* commands = reinterpret_cast<const LipacCommand*>(returned.buffer.mapped() + kCommandsAt);
    for (uint32_t i = 0; i < std::min(status.commands, command_capacity_); ++i) {
      if (commands[i].slot & shared::kCommandRemove) granted_.erase(commands[i].slot & ~shared::kCommandRemove);
      else asked_.push_back(commands[i]);
    }
    figures_.cpu_visits += status.commands;
  }
  // The GPU appends in whatever order its threads come.
  std::sort(asked_.begin(), asked_.end(), [](const LipacCommand& a, const LipacCommand& b) {
    return a.hits != b.hits ? a.hits > b.hits : a.slot < b.slot;
  });
}

std::vector<uint32_t> Lipac::begin(std::span<const Sight> sights, const InstanceTable& table, const Units& units) {
  auto start = Clock::now();
  readCommands();
  figures_.commands_ms = millisecondsSince(start);
  start = Clock::now();
  appearance_.begin(sights, edited_, table, units);
  figures_.sight_ms = millisecondsSince(start);
  edited_.clear();
  figures_.cpu_visits += appearance_.visits();
  for (const uint32_t slot : appearance_.slots()) patches_.push_back({slot, shared::kPatchOpen});

  std::vector<uint32_t> wanted;
  for (auto slot = granted_.begin(); slot != granted_.end();) {
    const uint32_t unit = units.unitOf(*slot);
    if (unit == scene::kNone) {
      slot = granted_.erase(slot);
    } else {
      wanted.push_back(unit);
      ++slot;
    }
  }
  figures_.cpu_visits += wanted.size();
  // In turns, so that neither starves the other.
  std::vector<bool> listed(units.units().size());
  const auto list = [&](uint32_t unit) {
    if (unit == scene::kNone || listed[unit] || granted_.contains(units.units()[unit].slot)) return;
    listed[unit] = true;
    wanted.push_back(unit);
  };
  const std::vector<uint32_t>& shown = appearance_.units();
  for (size_t i = 0; i < std::max(asked_.size(), shown.size()); ++i) {
    if (i < asked_.size()) list(units.unitOf(asked_[i].slot));
    if (i < shown.size()) list(shown[i]);
  }
  return wanted;
}

/// Threads apply patches in any order, so a slot's word has one of them.
void Lipac::patch(uint32_t slot, uint32_t action) {
  const auto reset = std::find_if(patches_.begin(), patches_.end(), [slot](const shared::LipacPatch& p) {
    return p.slot == slot && p.action == shared::kPatchReset;
  });
  if (reset == patches_.end()) patches_.push_back({slot, action});
  else if (action == shared::kPatchShow) reset->action = shared::kPatchShowAnew;
}

void Lipac::serve(const OwnBlases& blases, const Units& units) {
  figures_.wanted = static_cast<uint32_t>(asked_.size());
  figures_.served = 0;
  for (const LipacCommand& command : asked_) {
    const uint32_t unit = units.unitOf(command.slot);
    if (unit == scene::kNone || !blases.inTlas(unit)) continue;
    granted_.insert(command.slot);
    patch(command.slot, shared::kPatchGrant);
    ++figures_.served;
  }
  figures_.left_over = figures_.wanted - figures_.served;
  figures_.shown = figures_.unshown = 0;
  for (const uint32_t unit : appearance_.units()) {
    if (!blases.inTlas(unit)) {
      ++figures_.unshown;
      continue;
    }
    appearance_.noteShown(unit);
    const uint32_t slot = units.units()[unit].slot;
    if (!granted_.insert(slot).second) continue;  // it had one, or its hits asked for it
    patch(slot, shared::kPatchShow);
    ++figures_.shown;
  }
}

TlasRoom Lipac::wantedRoom(uint32_t instances, bool all_count) const {
  const uint32_t guess = std::min(instances, std::max(kFirstGuess, instances / 16));
  const TlasRoom known = room_known_.counted ? room_known_ : TlasRoom{guess, guess};
  const auto appearing = static_cast<uint32_t>(appearance_.blocks().size()) * shared::kOrderBlock;
  const uint32_t more = std::min(instances, appearing);
  return {all_count ? 0 : known.surfaces + more, known.counted + more};
}

void Lipac::grow(gpu::Commands& commands, const LipacWorld& world, uint32_t unit_count) {
  using enum gpu::MemoryCategory;
  // Counters keep what they hold; what is new begins with nothing.
  const auto keep = [&](gpu::Buffer& buffer, const char* name) {
    const uint64_t bytes = uint64_t{powerAbove(world.slots, 1024)} * sizeof(uint32_t);
    if (buffer.size() >= bytes) return;
    gpu::Buffer larger(device_, {name, bytes, ray_tracing});
    commands.fill(larger, 0);
    if (buffer && !fresh_) {
      commands.barrier(gpu::use::transfer_write, gpu::use::transfer_write);
      commands.copy(buffer, larger, buffer.size());
    }
    if (buffer) commands.retire(std::move(buffer));
    buffer = std::move(larger);
  };
  if (fresh_) {
    commands.fill(hitboxes_, 0);
    if (words_) commands.fill(words_, 0);
    if (hits_) commands.fill(hits_, 0);
    commands.barrier(gpu::use::transfer_write, gpu::use::transfer_write);
  }
  keep(words_, "state words of instances");
  keep(hits_, "hits of instances");
  keep(untraced_, "what rays do not meet");
  fresh_ = false;

  const auto renew = [&](gpu::Buffer& buffer, const char* name, uint64_t bytes) {
    if (buffer.size() >= bytes) return;
    if (buffer) commands.retire(std::move(buffer));
    buffer = gpu::Buffer(device_, {name, bytes, ray_tracing});
  };
  const uint32_t entries = powerAbove(world.count, 1024);
  renew(entries_, "entries of the order", uint64_t{entries} * sizeof(uint32_t));
  renew(entry_sums_, "sums of entries", uint64_t{groups(entries)} * sizeof(glm::uvec2));
  // Whoever needs a BLAS of its own gives one command a tick at most.
  if (const uint32_t capacity = powerAbove(unit_count, 256); capacity > command_capacity_) {
    command_capacity_ = capacity;
    const uint64_t bytes = kCommandsAt + uint64_t{capacity} * sizeof(LipacCommand);
    renew(result_, "what culling came to", bytes);
    for (Returned& returned : returned_)
      returned = {gpu::Buffer(device_, {"what culling came to, read back", bytes, transfer, gpu::Placement::readback}),
                  false};
  }
}

void Lipac::upload(gpu::Commands& commands, const LipacWorld& world, uint32_t unit_count) {
  const auto start = Clock::now();
  grow(commands, world, unit_count);
  const uint64_t patch_bytes = patches_.size() * sizeof(shared::LipacPatch);
  if (patch_buffer_.size() < patch_bytes) {
    if (patch_buffer_) commands.retire(std::move(patch_buffer_));
    patch_buffer_ = gpu::Buffer(
        device_, {"what culling was told", patch_bytes + patch_bytes / 2, gpu::MemoryCategory::ray_tracing});
  }
  if (!patches_.empty()) commands.upload<shared::LipacPatch>(patch_buffer_, 0, patches_);
  const std::vector<shared::LipacSight>& sights = appearance_.blocks();
  if (!sights.empty()) {
    const std::vector<shared::CullVolume>& volumes = appearance_.volumes();
    const auto fit = [&](gpu::Buffer& buffer, const char* name, uint64_t bytes) {
      if (buffer.size() >= bytes) return;
      if (buffer) commands.retire(std::move(buffer));
      buffer = gpu::Buffer(device_, {name, bytes + bytes / 2, gpu::MemoryCategory::ray_tracing});
    };
    fit(sight_buffer_, "what comes into sight", sights.size() * sizeof(shared::LipacSight));
    fit(volume_buffer_, "what viewers see", volumes.size() * sizeof(shared::CullVolume));
    commands.upload<shared::LipacSight>(sight_buffer_, 0, sights);
    commands.upload<shared::CullVolume>(volume_buffer_, 0, volumes);
  }

  tick_ = {};
  tick_.order = world.order;
  tick_.instances = world.instances;
  tick_.meshes = world.meshes;
  tick_.needs = world.needs;
  tick_.bounds = bounds_.address();
  tick_.hits = hits_.address();
  tick_.words = words_.address();
  tick_.entries = entries_.address();
  tick_.untraced = untraced_.address();
  tick_.cells = hitboxes_.address();
  tick_.reaches = reaches_.address();
  tick_.entry_sums = entry_sums_.address();
  tick_.box_sums = box_sums_.address();
  tick_.status = result_.address();
  tick_.commands = result_.address() + kCommandsAt;
  tick_.patches = patches_.empty() ? 0 : patch_buffer_.address();
  tick_.cube = cube_.address();
  tick_.sights = sights.empty() ? 0 : sight_buffer_.address();
  tick_.volumes = sights.empty() ? 0 : volume_buffer_.address();
  tick_.sight_count = static_cast<uint32_t>(sights.size());
  tick_.smoothing = appearance_.smoothing();
  resting_ = world.rests && tick_.smoothing == settings_.smoothing ? resting_ + 1 : 0;
  tick_.smoothing += std::min(resting_, shared::kSmoothingAtRest - settings_.smoothing);
  tick_.mitigation = settings_.mitigation;
  tick_.grid_x = grid_.x;
  tick_.grid_z = grid_.z;
  tick_.grid_blocks_x = grid_.blocks_x;
  tick_.grid_blocks_z = grid_.blocks_z;
  tick_.count = world.count;
  tick_.command_capacity = command_capacity_;
  tick_.patch_count = static_cast<uint32_t>(patches_.size());
  tick_.tick = ticks_;
  tick_.box_activate = threshold(settings_.box_activate);
  tick_.box_deactivate = threshold(settings_.box_deactivate);
  tick_.own_activate = threshold(settings_.own_activate);
  tick_.own_deactivate = threshold(settings_.own_deactivate);
  tick_.box_above = settings_.frames_above;
  tick_.box_below = settings_.frames_below;
  tick_.own_above = settings_.literal ? 1 : settings_.frames_above;
  tick_.own_below = settings_.literal ? 1 : settings_.frames_below;
  tick_.box_flags = VK_GEOMETRY_INSTANCE_TRIANGLE_FACING_CULL_DISABLE_BIT_KHR;
  if (settings_.box_hits == BoxHits::any_hit) tick_.box_flags |= VK_GEOMETRY_INSTANCE_FORCE_NO_OPAQUE_BIT_KHR;
  tick_.literal = settings_.literal;
  tick_.rests = world.rests;
  figures_.upload_ms = millisecondsSince(start);
}

void Lipac::dispatch(gpu::Commands& commands, const gpu::ComputePipeline& pipeline, uint32_t threads) const {
  commands.bind(pipeline);
  commands.push(shared::LipacPush{tick_buffer_.address()});
  commands.dispatch(groups(threads));
}

void Lipac::assemble(gpu::Commands& commands, const TlasTable& surfaces, const TlasTable& counted) {
  const auto wait = [&] { commands.barrier(gpu::use::compute_write, gpu::use::compute_write); };
  tick_.counted = counted.instances;
  tick_.counted_capacity = counted.capacity;
  tick_.output_ = surfaces.instances;
  tick_.capacity = surfaces.capacity;
  commands.upload<shared::LipacTick>(tick_buffer_, 0, std::span(&tick_, 1));
  commands.barrier(gpu::use::transfer_write, gpu::use::compute_write);
  dispatch(commands, reset_, grid_.cells());
  wait();
  if (tick_.patch_count > 0) {
    dispatch(commands, patch_, tick_.patch_count);
    wait();
  }
  if (tick_.sight_count > 0) {
    dispatch(commands, appear_, tick_.sight_count * shared::kOrderBlock);
    wait();
  }
  patches_.clear();
  dispatch(commands, classify_, tick_.count);
  wait();
  dispatch(commands, count_boxes_, grid_.cells());
  wait();
  dispatch(commands, count_entries_, tick_.count);
  wait();
  commands.bind(offsets_);
  commands.push(shared::LipacPush{tick_buffer_.address()});
  commands.dispatch(1);
  wait();
  dispatch(commands, emit_, tick_.count);
  dispatch(commands, emit_boxes_, std::max({grid_.cells(), surfaces.capacity, counted.capacity}));
}

void Lipac::feedback(gpu::Commands& commands, bool counted) {
  const auto wait = [&] { commands.barrier(gpu::use::compute_write, gpu::use::compute_write); };
  if (counted) {
    dispatch(commands, gather_, tick_.count);
    wait();
    dispatch(commands, decide_hitboxes_, grid_.cells());
    wait();
    dispatch(commands, decide_, tick_.count);
  }
  commands.barrier(gpu::use::compute_write, gpu::use::transfer_read);
  Returned& returned = returned_[ticks_ % kDelay];
  commands.copy(result_, returned.buffer, result_.size());
  commands.barrier(gpu::use::transfer_write, gpu::use::host_read);
  returned.written = true;
  ++ticks_;
}

void Lipac::forget() {
  fresh_ = true;
  granted_.clear();
  asked_.clear();
  patches_.clear();
  appearance_.forget();
  room_known_ = {};
  for (Returned& returned : returned_) returned.written = false;
}

LipacFigures Lipac::figures() const {
  LipacFigures figures = figures_;
  const Returned& returned = returned_[(ticks_ + kDelay - 1) % kDelay];
  if (!returned.written) return figures;
  LipacStatus status = statusIn(returned);
  // While not every viewer has counted, or nobody does, states are what they were.
  if (!isCounted(status)) std::copy(states_known_.begin(), states_known_.end(), std::begin(status.states));
  figures.inactive = status.states[shared::kStateInactive];
  figures.omitted = status.states[shared::kStateOmitted];
  figures.requested = status.states[shared::kStateRequested];
  figures.active = status.states[shared::kStateActive];
  figures.active_hitboxes = status.active_hitboxes;
  figures.boxes = status.boxes;
  figures.entries = status.entries;
  figures.dropped = status.dropped;
  figures.box_hits = status.box_hits / shared::kHitUnit;
  figures.changes = status.changes;
  figures.cycles = status.cycles;
  figures.opened = status.opened;
  return figures;
}

std::span<const LipacCommand> Lipac::commands() const {
  const Returned& returned = returned_[(ticks_ + kDelay - 1) % kDelay];
  if (!returned.written) return {};
  const uint32_t count = std::min(statusIn(returned).commands, command_capacity_);
  return {reinterpret_cast<const LipacCommand*>(returned.buffer.mapped() + kCommandsAt), count};
}

uint64_t Lipac::bytes() const {
  uint64_t bytes = cube_.size();
  for (const gpu::Buffer* buffer :
       {&bounds_, &cube_positions_, &cube_indices_, &words_, &hits_, &untraced_, &entries_, &hitboxes_, &reaches_,
        &entry_sums_, &box_sums_, &tick_buffer_, &patch_buffer_, &sight_buffer_, &volume_buffer_, &result_})
    bytes += buffer->size();
  return bytes;
}

}  // namespace helio::accel
