#version 460
#extension GL_GOOGLE_include_directive : require
// Accumulates many samples, made up as they come, in one invocation; and sums the same in integers.
#include "probe.glsl"
#include "lib/accumulation.glsl"
#include "lib/random.glsl"

layout(buffer_reference, scalar) readonly buffer Questions { AccumulationQuestion items[]; };
layout(buffer_reference, scalar) writeonly buffer Answers { AccumulationAnswer items[]; };

// Sample i in units of 1 / kAccumulationUnit, below 2^20: floats hold it exactly.
uint sampleAt(AccumulationQuestion q, uint i) {
  const uint random = pcg4d(uvec4(i, q.seed, q.kind, 1u)).x;
  if (q.kind == kAccumulateNoise) return random >> 16;
  if (q.kind == kAccumulateSpikes) return random % 1000u == 0u ? 0xfffffu : 7u;
  if (q.kind == kAccumulateDarkening) return i < q.count / 100u ? 0xfffffu : random >> 22;
  return 1234u + q.seed;  // kAccumulateConstant
}

void main() {
  const uint item = gl_GlobalInvocationID.x;
  if (item >= probe.count) return;
  const AccumulationQuestion q = Questions(probe.questions).items[item];
  vec4 mean = vec4(0.0);
  uint64_t sum = 0ul;
  for (uint i = 0u; i < q.count; ++i) {
    const uint units = sampleAt(q, i);
    mean = runningMean(mean, vec3(float(units) / float(kAccumulationUnit)), randomAt(uvec2(item, q.kind), i, 7u).xyz);
    sum += uint64_t(units);
  }
  Answers(probe.answers).items[item] = AccumulationAnswer(sum, mean.x, mean.a);
}
