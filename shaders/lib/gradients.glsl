// Samples of the tick before that are shaded again in this one (shared/gradients.h).
#ifndef HELIO_GRADIENTS_GLSL
#define HELIO_GRADIENTS_GLSL
#include "lib/history.glsl"
#include "lib/hit.glsl"
#include "shared/gradients.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer GradientSampleTable { GradientSample items[]; };

uvec2 strata() { return (uvec2(frame.width, frame.height) + kStratum - 1u) / kStratum; }
uint stratumIndex(uvec2 stratum) { return stratum.y * strata().x + stratum.x; }

// A stratum is claimed by one sample of the tick before, which is shaded at one of its pixels: 0: by none.
uint packClaim(uint sample_index, uvec2 pixel) {
  const uvec2 local = pixel % kStratum;
  return sample_index * kStratum * kStratum + local.y * kStratum + local.x + 1u;
}
uint claimOf(uvec2 stratum) { return history.reshades == 0u ? 0u : imageLoad(images_r32ui[history.claims], ivec2(stratum)).x; }
uint claimedSample(uint claim) { return (claim - 1u) / (kStratum * kStratum); }
uvec2 claimedPixel(uint claim, uvec2 stratum) {
  const uint local = (claim - 1u) % (kStratum * kStratum);
  return stratum * kStratum + uvec2(local % kStratum, local / kStratum);
}

// A stratum's sample.
struct KeptSample {
  bool there;
  uvec2 pixel;  // whose random numbers it has
  Hit hit;
  uint mesh;
  vec2 luminance;  // diffuse, specular; times the unit that was
};
KeptSample keptSample(uint index) {
  const GradientSample kept = GradientSampleTable(history.gradient_samples).items[index];
  Hit hit = unpackHit(kept.hit);
  hit.barycentrics = kept.barycentrics;
  const uvec2 stratum = uvec2(index % strata().x, index / strata().x);
  const uint place = kept.mesh >> kPlaceShift;
  return KeptSample(kept.mesh != kNothing, stratum * kStratum + uvec2(place % kStratum, place / kStratum), hit,
                    kept.mesh & ((1u << kPlaceShift) - 1u), unpackHalf2x16(kept.luminance));
}

// The sample that is shaded again at the pixel; false: the pixel's own is new.
bool reshadedAt(uvec2 pixel, out KeptSample again) {
  const uint claim = claimOf(pixel / kStratum);
  if (claim == 0u || claimedPixel(claim, pixel / kStratum) != pixel) return false;
  again = keptSample(claimedSample(claim));
  return true;
}

#endif
