// The TLAS's entries on the GPU against what the rules say, with room for all and with too little.
#include <algorithm>
#include <cmath>
#include <random>

#include "accel/lipac_fixture.h"

namespace helio::accel {
namespace {

using namespace shared;

constexpr uint64_t kMeshBlas = 0x1000;
/// What a table holds before: every place must be written.
constexpr TlasInstance kGarbage{{}, 0x5a5a5a5a, 0x5a5a5a5a, 0x5a5a5a5a};

/// The cell at (x, z) metres: blocks row by row, cells in Morton order within.
uint32_t cellAt(const LipacGrid& grid, float x, float z) {
  const auto column = static_cast<uint32_t>(static_cast<int>(std::floor(x / 16.0f)) - grid.x);
  const auto row = static_cast<uint32_t>(static_cast<int>(std::floor(z / 16.0f)) - grid.z);
  uint32_t code = 0;
  for (uint32_t bit = 0; bit < 5; ++bit) code |= (column >> bit & 1u) << 2 * bit | (row >> bit & 1u) << (2 * bit + 1);
  return (row / 32 * grid.blocks_x + column / 32) * 1024 + code;
}

bool same(const TlasInstance& a, const TlasInstance& b) {
  return std::equal(std::begin(a.rows), std::end(a.rows), std::begin(b.rows)) && a.blas == b.blas &&
         a.custom_index_and_mask == b.custom_index_and_mask && a.hit_group_and_flags == b.hit_group_and_flags;
}

uint32_t maskOf(const TlasInstance& entry) { return entry.custom_index_and_mask >> 24; }

struct Entry {
  uint32_t index, mask;
  bool operator==(const Entry&) const = default;
};

class LipacAssembly : public LipacFixture {
 protected:
  static constexpr uint32_t kCount = 3000;

  void SetUp() override {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-200.0f, 200.0f), height(0.0f, 30.0f);
    records.resize(kCount);
    words.resize(kCount);
    for (uint32_t slot = 0; slot < kCount; ++slot) {
      // Cubes, some of them larger than two cells, some thin.
      const float size = slot % 97 == 0 ? 50.0f : 4.0f, thick = slot % 31 == 0 ? 0.02f : 4.0f;
      const glm::vec3 at(place(random), height(random), place(random));
      records[slot] = {{{size, 0, 0, at.x}, {0, thick, 0, at.y}, {0, 0, size, at.z}}, 0, 0.0f, 0};
      if (slot % 50 == 3) records[slot].mesh = kNoMesh;
      order.push_back(slot);
      words[slot] = (slot % 4) | (random() % 60'000) << kSmoothedShift;
    }
    std::shuffle(order.begin(), order.end(), random);
  }

  /// What the TLAS for rays that count gets, with so much room. `capacity`: of the other one; 0: there is none.
  std::vector<Entry> expected(const LipacGrid& grid, uint32_t capacity, uint32_t counted_capacity,
                              std::vector<uint32_t>& dropped) const {
    struct Candidate {
      uint32_t slot, rank;
      bool box;
    };
    std::vector<Candidate> candidates;
    std::vector<bool> boxes(grid.cells());
    for (const uint32_t slot : order) {
      if (records[slot].mesh == kNoMesh) continue;
      const bool large = slot % 97 == 0;
      const uint32_t state = words[slot] & 3u, smoothed = words[slot] >> kSmoothedShift;
      const uint32_t rank = large ? 31 : smoothed == 0 ? 0 : static_cast<uint32_t>(std::log2(smoothed)) + 1;
      if (large || state != kStateInactive) candidates.push_back({slot, rank, !large && state == kStateOmitted});
      else boxes[cellAt(grid, records[slot].rows[0].w, records[slot].rows[2].w)] = true;
    }
    const auto box_count = static_cast<uint32_t>(std::count(boxes.begin(), boxes.end(), true));
    uint32_t room = counted_capacity - std::min(counted_capacity, box_count);
    if (capacity > 0) room = std::min(room, capacity);
    // Who has the most hits stays; among equals who comes first.
    std::vector<size_t> by_rank(candidates.size());
    for (size_t i = 0; i < by_rank.size(); ++i) by_rank[i] = i;
    std::stable_sort(by_rank.begin(), by_rank.end(),
                     [&](size_t a, size_t b) { return candidates[a].rank > candidates[b].rank; });
    std::vector<bool> stays(candidates.size());
    for (size_t i = 0; i < std::min<size_t>(room, by_rank.size()); ++i) stays[by_rank[i]] = true;
    std::vector<Entry> entries;
    for (size_t i = 0; i < candidates.size(); ++i) {
      if (stays[i]) entries.push_back({candidates[i].slot, candidates[i].box ? kMaskOmitted : kMaskSolid});
      else dropped.push_back(candidates[i].slot);
    }
    for (uint32_t cell = 0; cell < grid.cells(); ++cell)
      if (boxes[cell] && entries.size() < counted_capacity) entries.push_back({cell, kMaskCell});
    return entries;
  }

  struct Assembled {
    std::vector<TlasInstance> entries;  // surfaces and boxes
    std::vector<uint32_t> hits, words, needs;
    LipacGrid grid;
    LipacFigures figures;
    uint64_t cube = 0;
  };
  Assembled assemble(uint32_t capacity, uint32_t counted_capacity, uint64_t blas = kMeshBlas) {
    Lipac lipac(*device, commands, *cubes(), {});
    const gpu::Buffer order_table = table("order", order), instances = table("instances", records);
    const gpu::Buffer meshes = table("meshes", std::vector<MeshRecord>{{blas, 0, 1, 0, 0}});
    const gpu::Buffer needs = table("needs", std::vector<uint32_t>(1));
    const gpu::Buffer surfaces = table("surfaces", std::vector<TlasInstance>(std::max(capacity, 1u), kGarbage));
    const gpu::Buffer counted = table("counted", std::vector<TlasInstance>(counted_capacity, kGarbage));
    commands.begin();
    lipac.upload(commands,
                 {order_table.address(), instances.address(), meshes.address(), needs.address(), kCount, kCount}, 0);
    barrier();
    commands.upload<uint32_t>(lipac.words(), 0, words);
    barrier();
    lipac.assemble(commands, capacity > 0 ? TlasTable{surfaces.address(), capacity} : TlasTable{},
                   {counted.address(), counted_capacity});
    barrier();
    lipac.feedback(commands, false);
    submit();
    std::vector<TlasInstance> entries = read<TlasInstance>(counted, counted_capacity);
    // Rays that do not count meet the same without boxes.
    const std::vector<TlasInstance> plain =
        capacity > 0 ? read<TlasInstance>(surfaces, capacity) : std::vector<TlasInstance>{};
    for (size_t place = 0; place < plain.size(); ++place) {
      const bool solid = place < entries.size() && entries[place].blas != 0 && maskOf(entries[place]) == kMaskSolid;
      if (solid) {
        EXPECT_TRUE(same(plain[place], entries[place])) << place;
      } else {
        EXPECT_EQ(plain[place].blas, 0u) << place;
      }
    }
    return {std::move(entries),
            read<uint32_t>(lipac.hits(), kCount),
            read<uint32_t>(lipac.words(), kCount),
            read<uint32_t>(needs, 1),
            lipac.grid(),
            lipac.figures()};
  }

  std::vector<uint32_t> order, words;
  std::vector<InstanceRecord> records;
};

TEST_F(LipacAssembly, CompactsInOrderAndDropsWhoIsHitLeast) {
  const std::pair<uint32_t, uint32_t> rooms[] = {{4000u, 4000u}, {2000u, 2000u}, {700u, 700u}, {64u, 64u},
                                                 {700u, 4000u},  {4000u, 700u},  {0u, 700u}};
  for (const auto& [capacity, counted_capacity] : rooms) {
    SCOPED_TRACE(testing::Message() << capacity << " surfaces, " << counted_capacity << " with boxes");
    const Assembled result = assemble(capacity, counted_capacity);
    std::vector<uint32_t> dropped;
    const std::vector<Entry> right = expected(result.grid, capacity, counted_capacity, dropped);
    std::vector<Entry> got;
    for (const TlasInstance& entry : result.entries) {
      if (entry.blas == 0) continue;
      got.push_back({entry.custom_index_and_mask & 0xffffffu, maskOf(entry)});
      const uint32_t group = got.back().mask == kMaskSolid     ? kHitGroupSurface
                             : got.back().mask == kMaskOmitted ? kHitGroupOmitted
                                                               : kHitGroupCell;
      EXPECT_EQ(entry.hit_group_and_flags & 0xffffffu, group);
      if (group == kHitGroupSurface) EXPECT_EQ(entry.blas, kMeshBlas);
      else EXPECT_NE(entry.blas, kMeshBlas);
    }
    EXPECT_EQ(got, right);
    EXPECT_EQ(result.figures.entries, right.size());
    for (size_t i = right.size(); i < result.entries.size(); ++i) ASSERT_EQ(result.entries[i].blas, 0u) << i;
    // Who was dropped knows it.
    std::vector<uint32_t> told;
    for (const uint32_t slot : order)
      if (result.hits[slot] == kHitDropped) told.push_back(slot);
    EXPECT_EQ(told, dropped);
    if (capacity == 4000u && counted_capacity == 4000u) EXPECT_TRUE(dropped.empty());
    else EXPECT_FALSE(dropped.empty());
  }
}

TEST_F(LipacAssembly, BoxesCoverWhatTheyStandFor) {
  const Assembled result = assemble(4000, 4000);
  const auto covers = [](const TlasInstance& box, const InstanceRecord& instance) {
    for (int axis = 0; axis < 3; ++axis) {
      const float low = box.rows[axis].w, high = low + box.rows[axis][axis];
      const float middle = instance.rows[axis].w, half = 0.5f * instance.rows[axis][axis];
      if (!(low <= middle - half + 1e-3f && high >= middle + half - 1e-3f) || !(high > low)) return false;
    }
    return true;
  };
  uint32_t checked = 0;
  for (const uint32_t slot : order) {
    if (records[slot].mesh == kNoMesh || slot % 97 == 0 || (words[slot] & 3u) >= kStateRequested) continue;
    const bool omitted = (words[slot] & 3u) == kStateOmitted;
    const uint32_t cell = cellAt(result.grid, records[slot].rows[0].w, records[slot].rows[2].w);
    const uint32_t key = omitted ? slot | kMaskOmitted << 24 : cell | kMaskCell << 24;
    const auto box = std::find_if(result.entries.begin(), result.entries.end(),
                                  [&](const TlasInstance& e) { return e.custom_index_and_mask == key; });
    ASSERT_NE(box, result.entries.end()) << slot;
    EXPECT_TRUE(covers(*box, records[slot])) << slot;
    ++checked;
  }
  EXPECT_GT(checked, kCount * 2 / 5);
}

TEST_F(LipacAssembly, WhatIsToEnterAsksForTheBlasThatItShares) {
  uint32_t most = 0;  // hits of those in the TLAS, and of those who wait
  for (const uint32_t slot : order)
    if (records[slot].mesh != kNoMesh && (slot % 97 == 0 || (words[slot] & 3u) >= kStateRequested))
      most = std::max(most, words[slot] >> kSmoothedShift);
  EXPECT_EQ(assemble(4000, 4000).needs.front(), most + 1);

  // Without it they wait, with their bounds in their places.
  const Assembled without = assemble(4000, 4000, 0);
  EXPECT_EQ(without.needs.front(), most + 1);
  for (const TlasInstance& entry : without.entries)
    if (entry.blas != 0) { ASSERT_NE(maskOf(entry), kMaskSolid); }
  for (const uint32_t slot : order)
    if (records[slot].mesh != kNoMesh && (slot % 97 == 0 || (words[slot] & 3u) >= kStateRequested)) {
      ASSERT_EQ(without.words[slot] & 3u, kStateRequested) << slot;
    }
}

}  // namespace
}  // namespace helio::accel
