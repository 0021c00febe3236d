// Light path guided culling [Kelling, Ströter, Kuijper 2024]: rays count whom they meet, and the TLAS holds what is met
// often. GPU-driven: the CPU sees commands, edits and BLASes of instances' own, never all instances. README.md explains
// it.
#pragma once

#include <array>
#include <set>
#include <span>
#include <vector>

#include "accel/appearance.h"
#include "accel/lipac_settings.h"
#include "accel/own_blases.h"
#include "accel/tlas_assembly.h"
#include "shared/lipac.h"

namespace helio::accel {

/// The tables that a tick's culling reads.
struct LipacWorld {
  VkDeviceAddress order = 0;      ///< uint: slots in Morton order
  VkDeviceAddress instances = 0;  ///< InstanceRecord by slot
  VkDeviceAddress meshes = 0;     ///< SharedBlases::table()
  VkDeviceAddress needs = 0;      ///< SharedBlases::needs(); 0: nobody asks
  uint32_t count = 0;             ///< entries of the order
  uint32_t slots = 0;
  bool rests = false;  ///< neither viewers nor what they see moves: nothing tells that bounds fit better now
};

/// A rectangle of cells in the ground plane, in blocks of 32 x 32.
struct LipacGrid {
  int32_t x = 0, z = 0;  ///< the first cell
  uint32_t blocks_x = 0, blocks_z = 0;
  uint32_t cells() const { return blocks_x * blocks_z << 2 * shared::kBlockBits; }
};
/// Covers the scene's placements with a margin for what users build; at most 1024 x 1024 cells around its middle.
LipacGrid gridOf(const scene::Scene& scene);

/// Whether an instance's bounds are too large for a hitbox, so that it is always in the TLAS.
bool exceedsHitbox(const shared::InstanceRecord& instance, const scene::Aabb& mesh_bounds);

/// One a world. A tick calls, in this order: noteEdits, begin, serve, upload, assemble, (rays,) feedback.
/// Deterministic: states are a function of the hits of the ticks before.
class Lipac {
 public:
  /// Ticks from a command's writing to its reading.
  static constexpr uint32_t kDelay = 1;

  Lipac(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene, const LipacSettings& settings);

  /// Before `table` takes over the changes: whoever gets another's slot begins anew.
  void noteEdits(const world::ChangeSet& changes, const InstanceTable& table);
  /// Reads what the GPU asked for kDelay ticks ago, and finds what has come into sight. The units that need a BLAS in
  /// this tick: those that have one, then in turns those that are hit most and those that have just come into sight.
  std::vector<uint32_t> begin(std::span<const Sight> sights, const InstanceTable& table, const Units& units);
  /// The viewer is no more.
  void removeViewer(uint64_t viewer) { appearance_.remove(viewer); }
  /// After OwnBlases::plan(): grants what has a BLAS now. The rest is asked for again by the GPU.
  void serve(const OwnBlases& blases, const Units& units);
  /// Entries that the TLASes need room for, as far as is known. `all_count`: every path of this tick does.
  TlasRoom wantedRoom(uint32_t instances, bool all_count) const;

  /// Records the copies of what the passes below read (transfer writes).
  void upload(gpu::Commands& commands, const LipacWorld& world, uint32_t unit_count);
  /// Compute: applies what was granted, then writes the TLAS instances of surfaces, and those with boxes among them.
  void assemble(gpu::Commands& commands, const TlasTable& surfaces, const TlasTable& counted);
  /// Compute: weighs this tick's hits and changes states. `counted` false: not every viewer has counted yet, so states
  /// stay and counters go on. Ends with the copy that begin() reads.
  void feedback(gpu::Commands& commands, bool counted);
  /// After a tick that failed: everything begins anew.
  void forget();

  const Appearance& appearance() const { return appearance_; }  ///< of this tick; after begin()
  const LipacSettings& settings() const { return settings_; }
  uint32_t ticks() const { return ticks_; }  ///< so far
  /// Of the last tick; after its commands are done.
  LipacFigures figures() const;
  /// What it asked for, in no order. After its commands are done.
  std::span<const shared::LipacCommand> commands() const;
  const std::set<uint32_t>& granted() const { return granted_; }  ///< slots that have a BLAS of their own
  uint64_t bytes() const;

  VkDeviceAddress tickConstants() const { return tick_buffer_.address(); }  ///< LipacTick of this tick
  const LipacGrid& grid() const { return grid_; }
  const gpu::Buffer& words() const { return words_; }        ///< state words, by slot
  const gpu::Buffer& hits() const { return hits_; }          ///< counters, by slot
  const gpu::Buffer& untraced() const { return untraced_; }  ///< by slot: 0 where rays meet it in this tick
  const gpu::Buffer& entries() const { return entries_; }    ///< of this tick's order
  const gpu::Buffer& hitboxes() const { return hitboxes_; }

 private:
  struct Returned {
    gpu::Buffer buffer;  // LipacStatus, then commands
    bool written = false;
  };
  void grow(gpu::Commands& commands, const LipacWorld& world, uint32_t unit_count);
  shared::LipacStatus statusIn(const Returned& returned) const;
  void dispatch(gpu::Commands& commands, const gpu::ComputePipeline& pipeline, uint32_t threads) const;
  void readCommands();
  void patch(uint32_t slot, uint32_t action);

  gpu::Device& device_;
  LipacSettings settings_;
  LipacGrid grid_;
  gpu::Buffer bounds_, cube_positions_, cube_indices_;
  gpu::AccelerationStructure cube_;
  gpu::ComputePipeline patch_, reset_, appear_, classify_, count_boxes_, count_entries_, offsets_, emit_, emit_boxes_,
      gather_, decide_hitboxes_, decide_;

  gpu::Buffer words_, hits_, untraced_, entries_, hitboxes_, reaches_, entry_sums_, box_sums_;
  gpu::Buffer tick_buffer_, patch_buffer_, sight_buffer_, volume_buffer_,
      result_;  // result_: LipacStatus, then commands
  uint32_t command_capacity_ = 0;
  bool fresh_ = true;  // the counters hold nothing yet
  std::array<Returned, kDelay> returned_;

  shared::LipacTick tick_{};
  uint32_t ticks_ = 0;
  uint32_t resting_ = 0;                                  // ticks in a row in which nothing moved
  std::array<uint32_t, shared::kStates> states_known_{};  // of the last tick that counted them
  TlasRoom room_known_;                                   // that was wanted kDelay ticks ago; 0: not known
  std::set<uint32_t> granted_;
  std::vector<shared::LipacCommand> asked_;  // this tick's, most hits first
  Appearance appearance_;
  std::vector<uint32_t> edited_;  // slots, since the last begin()
  std::vector<shared::LipacPatch> patches_;
  LipacFigures figures_;
};

}  // namespace helio::accel
