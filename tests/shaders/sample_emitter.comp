#version 460
#extension GL_GOOGLE_include_directive : require
// Draws a point of an emissive triangle as seen from each item's `p`.
#include "probe.glsl"
#include "lib/emitters.glsl"

layout(buffer_reference, scalar) readonly buffer Questions { EmitterQuestion items[]; };
layout(buffer_reference, scalar) writeonly buffer Answers { EmitterDrawn items[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= probe.count) return;
  const vec3 p = Questions(probe.questions).items[i].p;
  const RandomNumbers u = RandomTable(probe.randoms).items[i];
  const EmitterSample s = sampleEmitter(selectEmitter(p, u.a.xyz), p, u.b.xy);
  Answers(probe.answers).items[i] = EmitterDrawn(s.position, s.pdf_area, s.emission, selectEmitter(p, u.a.xyz));
}
