// Questions to the functions of shaders/lib, and their answers: arrays of these, one item an invocation.
#ifndef HELIO_TEST_PROBE_H
#define HELIO_TEST_PROBE_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

// Samplers of directions.
HELIO_CONSTANT kSampleBsdf = 0u;
HELIO_CONSTANT kSampleVisibleNormal = 1u;
HELIO_CONSTANT kSampleCosine = 2u;
HELIO_CONSTANT kSampleSun = 3u;
HELIO_CONSTANT kSampleSky = 4u;  // `wo`: the normal of the plane above which it is looked for

struct ProbeConstants {
  uint64_t frame;      // FrameConstants; 0 where a probe needs none
  uint64_t questions;  // of the shader's type, `count` of them
  uint64_t randoms;    // RandomNumbers an item; 0 where a probe needs none
  uint64_t answers;    // of the shader's type
  uint count;
  uint routine;  // kSample...
  // Material of the BSDF.
  vec3 base;
  float metallic;
  float roughness;
  uint lambert;
  // Of the low-discrepancy sampler (SampleConstants).
  uint seed;
  uint log2_samples;
};
HELIO_CONSTANT kProbeGroup = 256u;

// A storage image of `size` x `size` texels becomes `value`.
struct FillConstants {
  uint slot;
  uint size;
  vec4 value;
};

// Numbers in [0, 1).
struct RandomNumbers {
  vec4 a;
  vec4 b;
};

// Two directions in the shading frame, or in world space for sun and sky.
struct DirectionQuestion {
  vec3 wo;
  vec3 wi;
};
struct DirectionDrawn {
  vec3 wi;
  float pdf;  // 0: nothing was drawn, -1: a mirror's
  vec3 weight;
};
struct DirectionDensity {
  vec3 value;  // f cos; BSDF only
  float pdf;   // per steradian
};

// Seen from `p`: a point of an emissive triangle, or an instance alone.
struct EmitterQuestion {
  vec3 p;
  uint slot;
  uint geometry;
  uint primitive;
  vec2 barycentrics;
};
struct EmitterDrawn {
  vec3 position;
  float pdf_area;
  vec3 emission;
  uint slot;
};
struct EmitterDensity {
  vec3 position;
  float pdf_area;
  vec3 emission;
  float slot_probability;
};

struct RandomQuestion {
  uint x;
  uint y;
  uint sample_index;
  uint dimension;  // or decision
};

// A run of `count` samples through the accumulation, and their exact sum.
HELIO_CONSTANT kAccumulateConstant = 0u;
HELIO_CONSTANT kAccumulateNoise = 1u;
HELIO_CONSTANT kAccumulateSpikes = 2u;     // one sample in a thousand is 150,000 times as bright as the others
HELIO_CONSTANT kAccumulateDarkening = 3u;  // the first hundredth is 1000 times as bright as the rest
HELIO_CONSTANT kAccumulationUnit = 1024u;
struct AccumulationQuestion {
  uint count;
  uint kind;  // kAccumulate...
  uint seed;
};
struct AccumulationAnswer {
  uint64_t sum;  // in units of 1 / kAccumulationUnit
  float mean;
  float samples;
};

HELIO_SHARED_END
#endif
