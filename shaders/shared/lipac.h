// Light path guided culling [Kelling, Ströter, Kuijper 2024, §3.2 to 3.5]: what counts hits and decides by them.
#ifndef HELIO_SHARED_LIPAC_H
#define HELIO_SHARED_LIPAC_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

// States of an instance; a hitbox is inactive or active.
HELIO_CONSTANT kStateInactive = 0u;   // not in the TLAS; its hitbox stands for it there
HELIO_CONSTANT kStateOmitted = 1u;    // its bounds stand for it
HELIO_CONSTANT kStateRequested = 2u;  // as omitted, until it has a BLAS
HELIO_CONSTANT kStateActive = 3u;     // in the TLAS
HELIO_CONSTANT kStates = 4u;

// A state word: state, ticks above and below a threshold in a row, completed cycles, whether it was met on a path of
// mirrors alone, and smoothed hits.
HELIO_CONSTANT kAboveShift = 2u;
HELIO_CONSTANT kAboveMost = 7u;  // 3 bits
HELIO_CONSTANT kGuessed = 1u;  // in place of the ticks above while active: it appeared, and hits have not confirmed it
HELIO_CONSTANT kBelowShift = 5u;
HELIO_CONSTANT kBelowMost = 15u;  // 4 bits
HELIO_CONSTANT kCyclesShift = 9u;
HELIO_CONSTANT kCyclesMost = 5u;  // 3 bits
HELIO_CONSTANT kMarkedBit = 0x1000u;
HELIO_CONSTANT kSmoothedShift = 13u;
HELIO_CONSTANT kSmoothedMost = 0x7ffffu;  // 19 bits

HELIO_CONSTANT kSmoothingAtRest = 64u;  // ticks that hits are averaged over where nothing moves, in the end
HELIO_CONSTANT kCycleDecay = 256u;      // ticks until a cycle is forgotten, unless nothing moves
HELIO_CONSTANT kNever = 0xffffffffu;    // a threshold that nothing reaches

// A counter of a tick: weighted hits in 1/8, so that a hit in a picture of 1920 x 1080 paths weighs 8.
HELIO_CONSTANT kHitUnit = 8u;
HELIO_CONSTANT kHitMarked = 0x80000000u;    // it was met on a path of mirrors alone
HELIO_CONSTANT kHitDropped = 0xffffffffu;   // it found no room in this tick's TLAS
HELIO_CONSTANT kReferencePaths = 2073600u;  // 1920 x 1080: what the thresholds refer to
// Pixels whose paths count together: neighbours on a GPU do the same.
HELIO_CONSTANT kCountTileX = 8u;
HELIO_CONSTANT kCountTileY = 4u;

// The grid: square cells in the ground plane, Morton-ordered within blocks, which follow each other row by row.
HELIO_CONSTANT kCellMetres = 16u;
HELIO_CONSTANT kBlockBits = 5u;        // 32 x 32 cells
HELIO_CONSTANT kGridBlocksMost = 32u;  // a side: 1024 x 1024 cells
struct Hitbox {
  uint word;
  uint hits;
  uint lowest;  // of what is inactive in it, as an ordered integer; lowest > highest: nothing
  uint highest;
};

// An entry of the Morton order in this tick: what the feedback needs to know of it.
HELIO_CONSTANT kCellBits = 20u;
HELIO_CONSTANT kNoCell = 0xfffffu;  // too large for a cell, or outside of the grid: always active
HELIO_CONSTANT kRankShift = 20u;    // logarithm of its smoothed hits: who stays when room runs out
HELIO_CONSTANT kRankMost = 31u;
HELIO_CONSTANT kRanks = 32u;
HELIO_CONSTANT kKindShift = 25u;
HELIO_CONSTANT kKindNone = 0u;
HELIO_CONSTANT kKindInstance = 1u;
HELIO_CONSTANT kKindBox = 2u;
HELIO_CONSTANT kOwnBlasBit = 0x08000000u;  // it needs a BLAS of its own
HELIO_CONSTANT kHasBlasBit = 0x10000000u;
HELIO_CONSTANT kThereBit = 0x20000000u;  // rays could meet it

HELIO_CONSTANT kLipacGroup = 256u;
HELIO_CONSTANT kLipacScanGroup = 1024u;

// From the GPU to the CPU: make sure of a BLAS, or let go of it.
HELIO_CONSTANT kCommandRemove = 0x80000000u;
struct LipacCommand {
  uint slot;  // and kCommandRemove
  uint hits;  // weighted, in 1/8: the most urgent have the most
};

// From the CPU to the GPU.
HELIO_CONSTANT kPatchReset = 0u;     // another instance has the slot
HELIO_CONSTANT kPatchGrant = 1u;     // its BLAS is there
HELIO_CONSTANT kPatchShow = 2u;      // its BLAS is there, and it has just come into a viewer's sight
HELIO_CONSTANT kPatchShowAnew = 3u;  // the same, and another instance has the slot
HELIO_CONSTANT kPatchOpen = 4u;      // it has just come into sight: its hitbox becomes active
struct LipacPatch {
  uint slot;
  uint action;
};

// A block of the order that holds what has just come into a viewer's sight.
HELIO_CONSTANT kSightWhole = 0x80000000u;  // whatever the viewer sees of it, not only what it did not see before
struct LipacSight {
  uint block;   // and kSightWhole
  uint viewer;  // its volumes: 2 viewer for this tick, 2 viewer + 1 for the one before
};

// What a tick came to.
struct LipacStatus {
  uint commands;
  uint boxes;          // cells that want a box in the TLAS
  uint wanted;         // instances and their boxes that want an entry
  uint ranks[kRanks];  // the same, by rank
  uint entered;        // those of them that found room
  uint entries;        // the same, and boxes of cells that found room
  uint dropped;        // found no room
  uint states[kStates];
  uint active_hitboxes;
  uint box_hits;  // of hitboxes, in 1/8
  uint changes;   // instances whose state changed
  uint cycles;    // hitboxes and instances of own BLASes that went back
  uint opened;    // hitboxes that became active because something in them came into sight
};

// Every pass gets the address of one of these.
struct LipacTick {
  uint64_t order;       // uint: slots
  uint64_t instances;   // InstanceRecord, by slot
  uint64_t meshes;      // MeshRecord, of what rays meet
  uint64_t needs;       // uint, as the mesh table: how much its BLAS is needed; 0: nobody asks
  uint64_t bounds;      // MeshBounds a mesh
  uint64_t hits;        // uint, by slot
  uint64_t words;       // uint, by slot
  uint64_t entries;     // uint, as `order`
  uint64_t untraced;    // uint, by slot: 0 where rays meet the instance
  uint64_t cells;       // Hitbox
  uint64_t reaches;     // uint a cell: metres beyond its sides, as a float's bits
  uint64_t entry_sums;  // uvec2 a group: entries that surely fit, entries that fit if there is room
  uint64_t box_sums;    // uint a group
  uint64_t counted;     // TlasInstance: what has a surface, and boxes of instances and of cells
  uint64_t output_;     // TlasInstance: the same without boxes; 0: every path counts, so nobody asks for it
  uint64_t status;      // LipacStatus
  uint64_t commands;    // LipacCommand
  uint64_t patches;     // LipacPatch
  uint64_t cube;        // the unit cube's BLAS
  uint64_t sights;      // LipacSight
  uint64_t volumes;     // CullVolume: two a viewer
  int grid_x;           // the grid's first cell
  int grid_z;
  uint grid_blocks_x;
  uint grid_blocks_z;
  uint count;             // entries of `order`
  uint counted_capacity;  // of `counted`
  uint capacity;          // of `output_`
  uint command_capacity;
  uint patch_count;
  uint sight_count;
  uint tick;
  // Thresholds in 1/8 hits.
  uint box_activate;
  uint box_deactivate;
  uint own_activate;
  uint own_deactivate;
  // Ticks in a row; of hitboxes and of instances.
  uint box_above;
  uint box_below;
  uint own_above;
  uint own_below;
  uint smoothing;   // ticks that hits are smoothed over
  uint mitigation;  // 1: what comes into an active hitbox is active at once
  uint box_flags;   // of boxes in the TLAS: VkGeometryInstanceFlagsKHR
  uint literal;     // 1: the paper's rules, without smoothing and damping
  uint rests;       // 1: nothing moves, so no cycle is forgotten
};

struct LipacPush {
  uint64_t tick;
};

struct MeshBounds {
  vec3 centre;
  vec3 half_extent;
};

HELIO_SHARED_END
#endif
