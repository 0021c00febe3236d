// The state machine on the GPU against one on the CPU, written from the rules: a million random steps.
#include <algorithm>
#include <map>
#include <random>

#include "accel/lipac_fixture.h"

namespace helio::accel {
namespace {

using namespace shared;

constexpr uint32_t kInstances = 4096, kCells = 300;

/// A counter as the rules have it: no bits.
struct Model {
  uint32_t state = kStateInactive;
  uint32_t above = 0, below = 0, cycles = 0;
  bool marked = false;
  uint32_t smoothed = 0;

  bool operator==(const Model&) const = default;
};

Model unpacked(uint32_t word) {
  return {word & 3u, word >> 2 & 7u, word >> 5 & 15u, word >> 9 & 7u, (word >> 12 & 1u) != 0, word >> 13};
}
uint32_t packed(const Model& m) {
  return m.state | m.above << 2 | m.below << 5 | m.cycles << 9 | uint32_t{m.marked} << 12 | m.smoothed << 13;
}

struct Rules {
  LipacSettings settings;
  uint32_t tick = 0;
  uint32_t resting = 0;  // ticks in a row in which nothing moved

  static uint32_t units(float hits) { return static_cast<uint32_t>(hits * 8.0f + 0.5f); }

  void take(Model& m, uint32_t hits, uint32_t index) const {
    const uint32_t most = std::min(hits, 524'287u);
    const uint32_t over = std::min(settings.smoothing + resting, 64u);
    m.smoothed = settings.literal ? most : ((over - 1) * m.smoothed + most + over / 2) / over;
    if (m.cycles > 0 && resting == 0 && (tick + index) % 256 == 0) --m.cycles;
  }
  void change(Model& m, uint32_t state) const {
    m.state = state;
    m.above = m.below = 0;
  }
  bool often(Model& m, uint32_t hits, float threshold, uint32_t ticks) const {
    const uint32_t raised = std::min<uint32_t>(units(threshold) * (1u << m.cycles), 524'287u - 32'767u);
    if (m.smoothed > raised) m.above = std::min(m.above + 1, 7u);
    else m.above = 0;
    return m.above >= ticks || ((resting == 0 || settings.literal) && hits > 2 * raised);
  }
  bool seldom(Model& m, float threshold, uint32_t ticks) const {
    if (m.smoothed < units(threshold)) m.below = std::min(m.below + 1, 15u);
    else m.below = 0;
    return m.below >= ticks;
  }
  void cycle(Model& m) const {
    if (!settings.literal) m.cycles = std::min(m.cycles + 1, 5u);
  }
};

struct Instance {
  uint32_t cell = 0;
  bool own = false, has_blas = false;
  uint32_t level = 0;  // hits that it gets about now
  Model model;
};

class LipacStates : public LipacFixture {
 protected:
  /// `ticks` ticks of all instances; every state word, hitbox and command is compared in each.
  void compare(const LipacSettings& settings, uint32_t ticks, uint32_t seed) {
    std::mt19937 random(seed);
    const auto below = [&](uint32_t most) { return static_cast<uint32_t>(random() % most); };
    Lipac lipac(*device, commands, *cubes(), settings);
    const uint32_t cells = lipac.grid().cells();
    Rules rules{settings, 0};

    std::vector<uint32_t> order(kInstances);
    for (uint32_t i = 0; i < kInstances; ++i) order[i] = kInstances - 1 - i;
    const gpu::Buffer order_table = table("order", order);
    const gpu::Buffer records =
        table("instances", std::vector<InstanceRecord>(kInstances, InstanceRecord{{}, kNoMesh, 0.0f, 0}));
    const gpu::Buffer surfaces = table("surfaces", std::vector<TlasInstance>(64));
    const gpu::Buffer counted = table("counted", std::vector<TlasInstance>(64));
    std::vector<Instance> instances(kInstances);
    std::vector<uint32_t> cell_ids(kCells), cell_levels(kCells);
    for (uint32_t& id : cell_ids) id = below(cells);
    for (Instance& instance : instances) {
      instance.cell = below(100) == 0 ? kNoCell : cell_ids[below(kCells)];
      instance.own = below(2) == 0;
      instance.has_blas = !instance.own && below(20) != 0;
    }
    std::vector<Model> hitboxes(cells);
    // From nothing to far above what activates, hitboxes sum up theirs.
    const auto level = [&] { return below(3) == 0 ? 0u : 1u << below(17); };
    uint64_t seen[kStates] = {}, changes = 0, cycles = 0;

    for (uint32_t t = 0; t < ticks; ++t) {
      // Grants, from the model's own words; and the BLASes that are shared come at some time.
      std::vector<uint32_t> words(kInstances);
      for (uint32_t slot = 0; slot < kInstances; ++slot) {
        Instance& instance = instances[slot];
        if (instance.model.state == kStateRequested && below(3) == 0) {
          instance.has_blas = true;
          rules.change(instance.model, kStateActive);
        }
        if (instance.own && instance.model.state < kStateRequested) instance.has_blas = false;
        if (instance.cell == kNoCell) instance.model.state = instance.has_blas ? kStateActive : kStateRequested;
        words[slot] = packed(instance.model);
        if (below(20) == 0) instance.level = level();
      }
      for (uint32_t& l : cell_levels)
        if (below(20) == 0) l = level();

      std::vector<uint32_t> hits(kInstances), entries(kInstances);
      for (uint32_t i = 0; i < kInstances; ++i) {
        const uint32_t slot = order[i];
        const Instance& instance = instances[slot];
        const uint32_t state = instance.model.state;
        const uint32_t kind = state == kStateActive ? kKindInstance : state == kStateInactive ? kKindNone : kKindBox;
        entries[i] = instance.cell | kind << kKindShift | kThereBit | (instance.own ? kOwnBlasBit : 0) |
                     (instance.has_blas ? kHasBlasBit : 0);
        if (kind == kKindNone) continue;
        hits[slot] = instance.level / 2 + below(instance.level + 1);
        if (hits[slot] > 0 && below(4) == 0) hits[slot] |= kHitMarked;
        if (instance.cell != kNoCell && below(500) == 0) hits[slot] = kHitDropped;
      }
      std::vector<Hitbox> boxes(cells);
      for (uint32_t cell = 0; cell < cells; ++cell) boxes[cell].word = packed(hitboxes[cell]);
      for (uint32_t c = 0; c < kCells; ++c)
        if (hitboxes[cell_ids[c]].state == kStateInactive)
          boxes[cell_ids[c]].hits = cell_levels[c] / 2 + below(cell_levels[c] + 1);

      commands.begin();
      rules.resting = t / 64 % 2 == 1 ? rules.resting + 1 : 0;
      lipac.upload(commands,
                   {order_table.address(), records.address(), 0, 0, kInstances, kInstances, rules.resting > 0},
                   kInstances);
      barrier();
      lipac.assemble(commands, {surfaces.address(), 64}, {counted.address(), 64});
      barrier();
      commands.upload<uint32_t>(lipac.words(), 0, words);
      commands.upload<uint32_t>(lipac.hits(), 0, hits);
      commands.upload<uint32_t>(lipac.entries(), 0, entries);
      commands.upload<Hitbox>(lipac.hitboxes(), 0, boxes);
      barrier();
      lipac.feedback(commands, true);
      submit();

      // The same by the rules. 1: hits of instances count for their hitbox.
      rules.tick = t;
      for (uint32_t i = 0; i < kInstances; ++i) {
        const uint32_t slot = order[i];
        if (instances[slot].cell != kNoCell && (entries[i] >> kKindShift & 3u) != kKindNone &&
            hits[slot] != kHitDropped)
          boxes[instances[slot].cell].hits += hits[slot] & ~kHitMarked;
      }
      // 2: hitboxes.
      for (uint32_t cell = 0; cell < cells; ++cell) {
        Model& m = hitboxes[cell];
        rules.take(m, boxes[cell].hits, cell);
        if (m.state == kStateInactive) {
          if (rules.often(m, boxes[cell].hits, settings.box_activate, settings.frames_above))
            rules.change(m, kStateActive);
        } else if (rules.seldom(m, settings.box_deactivate, settings.frames_below)) {
          rules.change(m, kStateInactive);
          rules.cycle(m);
          ++cycles;
        }
      }
      // 3: instances.
      std::map<uint32_t, uint32_t> expected;  // commands: slot and bit, hits
      const uint32_t own_above = settings.literal ? 1 : settings.frames_above;
      const uint32_t own_below = settings.literal ? 1 : settings.frames_below;
      for (uint32_t slot = 0; slot < kInstances; ++slot) {
        Instance& instance = instances[slot];
        Model& m = instance.model;
        const uint32_t before = m.state;
        const bool dropped = hits[slot] == kHitDropped;
        const uint32_t n = dropped ? 0 : hits[slot] & ~kHitMarked;
        rules.take(m, n, slot);
        m.marked = !dropped && (hits[slot] & kHitMarked) != 0;
        bool remove = false;
        if (instance.cell != kNoCell) {
          if (dropped || hitboxes[instance.cell].state == kStateInactive) {
            remove = instance.own && m.state >= kStateRequested;
            if (m.state != kStateInactive) rules.change(m, kStateInactive);
          } else if (m.state == kStateInactive) {
            rules.change(m, instance.own ? kStateOmitted : instance.has_blas ? kStateActive : kStateRequested);
          } else if (!instance.own) {
            // It stays as it is until its hitbox leaves or the BLAS that it shares comes.
          } else if (m.state == kStateOmitted) {
            if (rules.often(m, n, settings.own_activate, own_above)) rules.change(m, kStateRequested);
          } else if (rules.seldom(m, settings.own_deactivate, own_below)) {
            remove = true;
            if (m.state == kStateActive) {
              rules.cycle(m);
              ++cycles;
            }
            rules.change(m, kStateOmitted);
          }
        }
        if (remove) expected[slot | kCommandRemove] = 0;
        if (m.state == kStateRequested && instance.own) expected[slot] = std::max(n, m.smoothed) * (m.marked ? 4 : 1);
        ++seen[m.state];
        changes += m.state != before;
      }

      const auto words_after = read<uint32_t>(lipac.words(), kInstances);
      for (uint32_t slot = 0; slot < kInstances; ++slot)
        ASSERT_EQ(unpacked(words_after[slot]), instances[slot].model)
            << "slot " << slot << " in tick " << t << ": state " << (words_after[slot] & 3u) << ", by the rules "
            << instances[slot].model.state;
      const auto boxes_after = read<Hitbox>(lipac.hitboxes(), cells);
      for (uint32_t cell = 0; cell < cells; ++cell)
        ASSERT_EQ(unpacked(boxes_after[cell].word), hitboxes[cell]) << "cell " << cell << " in tick " << t;
      std::map<uint32_t, uint32_t> asked;
      for (const LipacCommand& command : lipac.commands()) asked[command.slot] = command.hits;
      ASSERT_EQ(asked, expected) << "commands of tick " << t;
    }
    // The steps went everywhere.
    for (uint32_t state = 0; state < kStates; ++state) EXPECT_GT(seen[state], uint64_t{ticks}) << "state " << state;
    EXPECT_GT(changes, uint64_t{ticks} * 10);
    EXPECT_GT(cycles, 10u);
  }
};

TEST_F(LipacStates, AMillionRandomStepsFollowTheRules) { compare({}, 250, 1); }

TEST_F(LipacStates, SoDoTheLiteralOnes) {
  LipacSettings settings;
  settings.literal = true;
  compare(settings, 40, 2);
}

TEST_F(LipacStates, AndOtherThresholds) {
  LipacSettings settings;
  settings.box_activate = 30.0f;
  settings.box_deactivate = 20.0f;
  settings.own_activate = 12.5f;
  settings.own_deactivate = 7.0f;
  settings.frames_above = 2;
  settings.frames_below = 3;
  compare(settings, 40, 3);
}

/// Ticks until it changes, with a steady number of hits; 0: not within 200.
class Hysteresis : public LipacStates {
 protected:
  static uint32_t after(const Rules& rules, Model m, uint32_t hits, bool up) {
    for (uint32_t t = 1; t <= 200; ++t) {
      rules.take(m, hits, 1);
      if (up ? rules.often(m, hits, 1000.0f, 4) : rules.seldom(m, 100.0f, 15)) return t;
    }
    return 0;
  }
};

TEST_F(Hysteresis, BetweenTheThresholdsNothingChanges) {
  const Rules rules;
  for (const uint32_t hits : {100u * 8, 300u * 8, 1000u * 8}) {
    EXPECT_EQ(after(rules, {}, hits, true), 0u) << hits;
    Model active;
    active.state = kStateActive;
    active.smoothed = 1000 * 8;
    EXPECT_EQ(after(rules, active, hits, false), 0u) << hits;
  }
  EXPECT_EQ(after(rules, {}, 2001 * 8, true), 1u);   // twice the threshold is enough at once
  EXPECT_GT(after(rules, {}, 1500 * 8, true), 15u);  // less must last
  Model active;
  active.state = kStateActive;
  active.smoothed = 1000 * 8;
  EXPECT_GT(after(rules, active, 0, false), 15u + 30u);
  // Each cycle doubles what it takes.
  Model tired;
  tired.cycles = 2;
  EXPECT_EQ(after(rules, tired, 2001 * 8, true), 0u);
  EXPECT_EQ(after(rules, tired, 8001 * 8, true), 1u);
}

}  // namespace
}  // namespace helio::accel
