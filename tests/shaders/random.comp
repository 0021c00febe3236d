#version 460
#extension GL_GOOGLE_include_directive : require
// The four numbers of each item's pixel, sample and dimension.
#include "probe.glsl"
#include "lib/random.glsl"

layout(buffer_reference, scalar) readonly buffer Questions { RandomQuestion items[]; };
layout(buffer_reference, scalar) writeonly buffer Answers { vec4 items[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= probe.count) return;
  const RandomQuestion q = Questions(probe.questions).items[i];
  Answers(probe.answers).items[i] = randomAt(uvec2(q.x, q.y), q.sample_index, q.dimension);
}
