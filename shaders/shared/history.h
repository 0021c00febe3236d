// What passes that look back are told: where things, and the camera, were in the tick before, and what a view kept of
// it.
#ifndef HELIO_SHARED_HISTORY_H
#define HELIO_SHARED_HISTORY_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

// A unit that moves: where it was in the tick before.
struct MotionRecord {
  vec4 rows[3];  // object to world
};
HELIO_CONSTANT kNoUnit = 0xffffffffu;

// Coarser images of light that the history fix of ReBLUR reads, each half of the one before.
HELIO_CONSTANT kHistoryMips = 4u;

// Ticks whose light is averaged at most: with a least share of 0.05 a new one counts for, more have no weight.
HELIO_CONSTANT kMostTicksOfLight = 63u;

// A view's, of one tick. Images are slots of the bindless set; 0 where the settings do not call for them.
//
// Radiance is stored in 16-bit floats, times `unit`: a power of two near the exposure, so that white is about 1.
struct HistoryConstants {
  // The camera of the tick before, as in FrameConstants.
  vec3 position;
  float tangent;
  vec3 right;
  vec3 up;
  vec3 forward;
  uint known;  // ticks before this one without a gap between them; 0: nothing is known of the tick before
  uint tick;

  // Where units were.
  uint moved;              // 0: where they are
  uint64_t unit_of_slot;   // uint a slot: kNoUnit where the instance is none; 0: there are no units
  uint64_t motions;        // MotionRecord a unit
  uint unit_of_slot_size;  // slots in the table

  float unit;
  float rescale;  // from values of the tick before to values of this one: units are no constants

  uint motion;  // rgba16f: to the tick before, in pixels and metres of depth; and |gradient of depth| a pixel
  // Of A-SVGF (shared/gradients.h).
  uint64_t gradient_samples;  // GradientSample a stratum, of the tick before
  uint reshades;              // 1: they are shaded again
  uint gradient_seed;         // of their random numbers
  uint claims;                // r32ui a stratum: packClaim()
  uint changes;               // rg8 a stratum: the share of the light that is another than before; diffuse, specular

  uint split;    // 1: there is light by lobe, and surfaces
  uint jitters;  // 1: in each tick another point of the pixel is seen, for TAA
  uint surface;  // rg32ui: packSurface(), packDepth() along `forward`
  uint previous_surface;
  uint albedos;   // rg32ui: packAlbedo() of the diffuse and of the specular directional albedo; 0: nothing is there
  uint emission;  // r32ui: packLight() of what the camera sees without a scattering
  // Two pairs of images hold light on its way: rg32ui: packLight(), diffuse and specular, over their albedos; rg16f:
  // standard deviations of their luminance. Of the first pair: this tick's samples, with the number of paths that they
  // are the mean of for a deviation: 1, more where further ones were drawn (shared/extra_samples.h), or 0 where a
  // sample was dropped (the second of the two is 1, 0, or with kHitDistances packHitDistance()); then their mean over
  // ticks. The second also holds, before it holds light:
  // - packHit() of the surface that is seen in a mirror, where `surface` says that one is;
  // - gradients while they are filtered (shared/gradients.h);
  // - this tick's moments and numbers of samples, until they can take the place of those of the tick before.
  uint sampled;
  uint sampled_deviation;
  // rg16f: the sun's light on the surface as if nothing stood in its way, by the diffuse and the specular lobe over
  // their albedos, in multiples of its colour; then, in x, the share of it that arrives, as a mean over ticks.
  uint sunlight;
  // Of ambient occlusion, rg8: what this tick's samples found, and the diffuse lobe's share of the sky's light that
  // comes through the coat; then means over ticks: the share of the sky that is seen, and ticks in units of
  // kMostTicksOfLight.
  uint occlusion;
  uint open_sky;
  uint previous_open_sky;
  uint spare;
  uint spare_deviation;
  uint filtered;  // rg32ui: packLight(), diffuse and specular: the mean over ticks that the next one goes on from
  uint moments;   // rg32ui: packHalf4() of a sample's luminance: mean and standard deviation, diffuse then specular
  uint samples;   // rg8: ticks in the history, in quarters; diffuse, specular
  // Of ReBLUR (shaders/reblur/reblur.glsl).
  uint stabilised;          // rg16f: luminance of what was shown in the tick before: diffuse, specular
  uint mips[kHistoryMips];  // rg32ui: light by lobe, this tick's mean
};

// What may be shown in the picture's place, as plain numbers.
HELIO_CONSTANT kInspectNothing = 0u;
HELIO_CONSTANT kInspectMotion = 1u;    // to the tick before: pixels to the right, pixels down, metres of depth
HELIO_CONSTANT kInspectPosition = 2u;  // of the first surface, world space, metres
HELIO_CONSTANT kInspectBefore = 3u;    // where that point of the surface was in the tick before, world space, metres
// This tick's diffuse and specular light, modulated and added up; with a denoiser, the sun's and the ambient light as
// they are shown.
HELIO_CONSTANT kInspectUnfiltered = 4u;
HELIO_CONSTANT kInspectDiffuse = 5u;  // mean over ticks, demodulated
HELIO_CONSTANT kInspectSpecular = 6u;
HELIO_CONSTANT kInspectSamples = 7u;  // in the history: diffuse, specular
HELIO_CONSTANT kInspects = 8u;

HELIO_SHARED_END
#endif
