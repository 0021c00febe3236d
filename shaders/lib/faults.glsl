// What is no light is dropped and counted, never shown and never averaged.
#ifndef HELIO_FAULTS_GLSL
#define HELIO_FAULTS_GLSL
#include "lib/tables.glsl"

// Why `v` is no radiance; kNoFault: it is. By bits, which no compiler may assume away.
uint faultOf(vec3 v) {
  const uvec3 magnitude = floatBitsToUint(v) & 0x7fffffffu;
  const uint kInfinity = 0x7f800000u;
  if (any(greaterThan(magnitude, uvec3(kInfinity)))) return kFaultNan;
  if (any(equal(magnitude, uvec3(kInfinity)))) return kFaultInfinite;
  return any(lessThan(v, vec3(0.0))) ? kFaultNegative : kNoFault;
}

// Of the sample that `push` names. Which place comes first does not depend on the order of invocations.
void countFault(uint pass_, uint cause, uvec2 pixel, uint vertex) {
  ViewStateRef view = ViewStateRef(frame.view_state);
  const uint kind = pass_ * kFaultCauses + cause, sample_ = ~push.sample_index;
  atomicAdd(view.state.faults.counts[kind], 1u);
  const uint first = atomicCompSwap(view.state.faults.first_sample, 0u, sample_);
  if (first != 0u && first != sample_) return;
  view.state.faults.seed = push.seed;
  const uint place = (pixel.y * frame.width + pixel.x) << kFaultVertexBits | vertex;
  atomicMax(view.state.faults.places[kind], ~place);
}

#endif
