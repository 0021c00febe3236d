// How cells are told of lamps beyond their lists (LightMemory.candidate).
#ifndef HELIO_LIGHT_CANDIDATES_GLSL
#define HELIO_LIGHT_CANDIDATES_GLSL
#include "shared/light_lists.h"

// A lamp, and in quarters of a stop how much light it sends: of two the larger one is the brighter lamp's.
uint packCandidate(uint slot, float irradiance) {
  const uint stops = uint(clamp(log2(irradiance) * 4.0 + 64.0, 1.0, 127.0));
  return stops << 25 | (slot & kPunctualLight) >> 7 | (slot & 0xffffffu);
}
uint candidateSlot(uint candidate) { return (candidate & 1u << 24) << 7 | (candidate & 0xffffffu); }
float candidateIrradiance(uint candidate) { return exp2((float(candidate >> 25) - 64.0) / 4.0); }

#endif
