// Which lamp, an emissive instance or a punctual light, to sample from a point: mostly one of those that matter to the
// point's cell, sometimes any of the world's in proportion to power, so that the estimate stays unbiased wherever light can
// come from.
#ifndef HELIO_LIGHTS_GLSL
#define HELIO_LIGHTS_GLSL
#include "lib/effects.glsl"
#include "lib/tables.glsl"

const float kGlobalShare = 0.25;

// Index of the cell of `p`; kNothing outside of the grid.
uint lightCellOf(vec3 p) {
  const vec2 cell = floor((p.xz - frame.light_grid_origin) * frame.light_cells_per_metre);
  if (any(lessThan(cell, vec2(0.0))) || any(greaterThanEqual(cell, vec2(frame.light_grid_size)))) return kNothing;
  return uint(cell.y) * frame.light_grid_size.x + uint(cell.x);
}

// About how much light, power over squared distance, the listed lights send to the cell of `p`; beyond the grid none is listed.
float cellIrradiance(vec3 p) {
  const uint index = lightCellOf(p);
  return index == kNothing ? frame.distant_irradiance : LightCellTable(frame.light_cells).items[index].irradiance;
}

// Probability that selectEmitter(p, ...) returns `slot`, whose weight is `weight`.
float emitterProbability(vec3 p, uint slot, float weight) {
  const float global = weight / frame.emitter_weight_sum;
  const uint index = lightCellOf(p);
  if (index == kNothing) return global;
  LightCellTable cells = LightCellTable(frame.light_cells);
  const uint count = cells.items[index].count;
  if (count == 0u) return global;
  float local = 0.0, below = 0.0;
  for (uint i = 0u; i < count; ++i) {
    const float cdf = cells.items[index].cdf[i];
    if (cells.items[index].slots[i] == slot) local = cdf - below;
    below = cdf;
  }
  return mix(local, global, kGlobalShare);
}

// How many lamps the vertex at hand draws; 0: each lamp once.
uint lamp_draws_ = 1u;

// How many lamps a cell has found, and whether `slot` is among those that the cell of `p` has: with kLightFeedback they are looked at
// one by one.
uint foundIn(uint cell) { return cell == kNothing ? 0u : LightCellTable(frame.light_cells).items[cell].found; }
bool foundFrom(vec3 p, uint slot) {
  const uint index = lightCellOf(p), found = foundIn(index);
  LightCellTable cells = LightCellTable(frame.light_cells);
  for (uint i = 0u; i < found; ++i)
    if (cells.items[index].slots[i] == slot) return true;
  return false;
}

// How often the vertex at `p` draws lamp `slot`, on average: what a sample of it is divided by, and its density is times.
float lampRate(vec3 p, uint slot, float weight) {
  if (kManyLamps && lamp_draws_ == 0u) return !kLightFeedback || foundFrom(p, slot) ? 1.0 : weight / frame.emitter_weight_sum;
  const float probability = emitterProbability(p, slot, weight);
  return kManyLamps ? float(lamp_draws_) * probability : probability;
}

// Any lamp of the world, in proportion to power; u in [0, 1)^2. By the alias method: an entry, and a coin that decides between it
// and its alias.
uint selectAnyEmitter(vec2 u) {
  const uint entry = min(uint(u.x * float(frame.emitter_instance_count)), frame.emitter_instance_count - 1u);
  const EmitterInstance chosen = EmitterInstanceTable(frame.emitter_instances).items[entry];
  return u.y < chosen.keep ? chosen.slot : EmitterInstanceTable(frame.emitter_instances).items[chosen.alias].slot;
}

// Chooses a lamp: the slot of an instance, or kPunctualLight and an index; u in [0, 1)^3.
uint selectEmitter(vec3 p, vec3 u) {
  const uint index = lightCellOf(p);
  LightCellTable cells = LightCellTable(frame.light_cells);
  const uint count = index == kNothing ? 0u : cells.items[index].count;
  if (count > 0u && u.x >= kGlobalShare) {
    uint i = 0u;
    while (i + 1u < count && u.y >= cells.items[index].cdf[i]) ++i;
    return cells.items[index].slots[i];
  }
  return selectAnyEmitter(u.yz);
}

#endif
