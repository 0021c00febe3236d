#version 460
#extension GL_GOOGLE_include_directive : require
// The density per area with which light sampling draws a point that a ray has met: what path_trace's weights rest on.
#include "probe.glsl"
#include "lib/emitters.glsl"

layout(buffer_reference, scalar) readonly buffer Questions { EmitterQuestion items[]; };
layout(buffer_reference, scalar) writeonly buffer Answers { EmitterDensity items[]; };

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= probe.count) return;
  const EmitterQuestion q = Questions(probe.questions).items[i];
  const Surface s = loadSurface(Hit(q.slot, q.geometry, q.primitive, q.barycentrics, 0u), vec3(0.0, -1.0, 0.0), 0.0, 0.0, q.p);
  const float slot_probability = emitterProbability(q.p, s.slot, s.emitter_weight);
  Answers(probe.answers).items[i] = EmitterDensity(s.position, slot_probability * s.emitter_pdf_area, s.emission, slot_probability);
}
