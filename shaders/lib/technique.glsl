// What techniques other than path tracing follow of a surface's light (shared/technique.h): its specular lobe alone, as a
// reflected ray. Light sampling then stands for the diffuse lobe on its own.
#ifndef HELIO_TECHNIQUE_GLSL
#define HELIO_TECHNIQUE_GLSL
#include "lib/bsdf.glsl"
#include "lib/sky.glsl"

const float kGlossyFloor = 0.1;

// The surface without its diffuse lobe.
Bsdf glossyPart(Bsdf b) {
  b.diffuse = vec3(0.0);
  return b;
}

// With which probability the reflected ray of the specular lobe is followed: about what the lobe reflects.
float glossyProbability(Bsdf b, vec3 wo) {
  if (!b.specular) return 0.0;
  const float s = maxComponent(fresnel(b, wo.z));
  if (kSpecular && s <= 0.0) return 0.0;
  return frame.roulette != 0u ? clamp(s, kGlossyFloor, 1.0) : 1.0;
}

// Draws a reflected ray; u.z decides whether there is one. The density counts that chance too.
bool sampleGlossy(Bsdf b, vec3 wo, vec3 u, out BsdfSample s) {
  const float probability = glossyProbability(b, wo);
  if (u.z >= probability) return false;
  if (!sampleBsdf(glossyPart(b), wo, vec3(u.xy, 0.0), s)) return false;
  s.weight /= probability;
  s.pdf *= probability;
  return true;
}

// What the specular lobe reflects of light from everywhere.
vec3 glossyAlbedo(Bsdf b, vec3 wo) { return b.compensation * coatAlbedo(b, b.coat.y * pow(clamp(1.0 - wo.z, 0.0, 1.0), b.coat.x)); }

// The sky's light over pi, as if nothing stood between it and a surface: the cosine-weighted mean of its gradient, whose height
// has the mean 2 / 3 of the normal's.
vec3 openSky(vec3 normal) {
  return kSkyGradient ? mix(frame.sky_ground, frame.sky_zenith, 0.5 + normal.y / 3.0) : frame.sky_zenith;
}

#endif
