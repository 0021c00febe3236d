#version 460
#extension GL_GOOGLE_include_directive : require
// The point of the unit square for each item's pixel, sample and decision, and the number beside it.
#include "probe.glsl"

SampleConstants sample_constants;
#define push sample_constants
#include "lib/sampler.glsl"

layout(buffer_reference, scalar) readonly buffer Questions { RandomQuestion items[]; };
layout(buffer_reference, scalar) writeonly buffer Answers { vec4 items[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= probe.count) return;
  const RandomQuestion q = Questions(probe.questions).items[i];
  sample_constants.sample_index = q.sample_index;
  sample_constants.seed = probe.seed;
  sample_constants.log2_samples = probe.log2_samples;
  const uvec2 pixel = uvec2(q.x, q.y);
  Answers(probe.answers).items[i] = vec4(pathSample2(pixel, q.dimension), pathSample1(pixel, q.dimension), 0.0);
}
