// Low-discrepancy samples: pairs of Owen-scrambled Sobol points [Owen 1995; hash-based after Laine and Karras 2011 and
// Burley 2020], padded over the dimensions of a path. A pixel's samples are a block of one sequence that runs through the
// picture along the Z curve [Ahmed and Wonka 2020], so that neighbours complement each other: the error is blue noise.
// A pure function of (seed, pixel, sample, decision).
#ifndef HELIO_SAMPLER_GLSL
#define HELIO_SAMPLER_GLSL
#include "lib/random.glsl"
#include "lib/tables.glsl"

// Bits of x and y in turn; a picture beyond 2048 x 2048 pixels repeats the curve.
uint zOrder(uvec2 p) {
  p &= 0x7ffu;
  p = (p | p << 8) & 0x00ff00ffu;
  p = (p | p << 4) & 0x0f0f0f0fu;
  p = (p | p << 2) & 0x33333333u;
  p = (p | p << 1) & 0x55555555u;
  return p.x | p.y << 1;
}

// Owen's nested uniform scrambling with the bits reversed: each bit is flipped or not by a hash of those below it. The
// constants are N. Vegdahl's; the golden one keeps seeds with few bits in their upper half from scrambling too little (without
// it one pair of decisions in twenty showed in a chi-square test of its joint distribution, with it one in sixty, weakly).
uint scrambleReversed(uint v, uint seed) {
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16 | 1u) * 0x9e3779b1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return v;
}

// Sobol's second dimension, bits reversed: the Pascal triangle modulo 2 times the index.
uint sobolReversed(uint index) {
  index ^= index >> 1 & 0x55555555u;
  index ^= index >> 2 & 0x33333333u;
  index ^= index >> 4 & 0x0f0f0f0fu;
  index ^= index >> 8 & 0x00ff00ffu;
  return index ^ index >> 16;
}

vec2 unitSquare(uvec2 v) { return vec2(v >> 8) * (1.0 / 16777216.0); }  // 24 bits, so that 1 is never reached

// A point of the scrambled (0, 2)-sequence; `reversed_index`: its place, bits reversed.
vec2 sobolPair(uint reversed_index, uint shuffle, uvec2 scramble) {
  // Shuffle the sequence within its blocks of powers of two, so that pairs of different dimensions are independent.
  const uint index = bitfieldReverse(scrambleReversed(reversed_index, shuffle));
  return unitSquare(bitfieldReverse(uvec2(scrambleReversed(index, scramble.x), scrambleReversed(sobolReversed(index), scramble.y))));
}

// A path may draw the random numbers of another seed.
uint other_seed_ = 0u;
bool has_other_seed_ = false;
uint sampleSeed() { return has_other_seed_ ? other_seed_ : push.seed; }

// A further path of the tick (shared/extra_samples.h): a pixel's are well spread among themselves, and of a seed of their own.
const uint kLog2ExtraPaths = 2u;
bool further_ = false;
void drawFurther() {
  further_ = has_other_seed_ = true;
  other_seed_ = pcg4d(uvec4(push.seed, push.sample_index, 0x66757274u, 0u)).x;
}
uint sampleIndex() { return further_ ? push.tick_sample - 1u : push.sample_index; }
uint log2Samples() { return further_ ? kLog2ExtraPaths : push.log2_samples; }

// A point of the unit square for `decision`, a number of the path's.
vec2 pathSample2(uvec2 pixel, uint decision) {
  if (frame.independent_samples != 0u) return randomAt(pixel, sampleIndex() + sampleSeed() * 0x9e3779b9u, decision).xy;
  const uint in_block = sampleIndex() & ((1u << log2Samples()) - 1u), block = sampleIndex() >> log2Samples();
  const uvec4 seeds = pcg4d(uvec4(decision, sampleSeed(), block, 0u));
  return sobolPair(bitfieldReverse(zOrder(pixel) << log2Samples() | in_block), seeds.x, seeds.yz);
}

// The same without low discrepancy: for decisions between yes and no, such as roulette.
float pathSample1(uvec2 pixel, uint decision) { return randomAt(pixel, sampleIndex() + sampleSeed() * 0x9e3779b9u, decision).x; }

#endif
