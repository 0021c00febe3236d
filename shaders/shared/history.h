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
  uint valid;  // 0: nothing is known of the tick before

  // Where units were.
  uint moved;              // 0: where they are
  uint64_t unit_of_slot;   // uint a slot: kNoUnit where the instance is none; 0: there are no units
  uint64_t motions;        // MotionRecord a unit
  uint unit_of_slot_size;  // slots in the table

  float unit;
  float rescale;       // from values of the tick before to values of this one: units are no constants
  float most_samples;  // of a texel's history

  uint motion;   // rgba16f: to the tick before, in pixels and metres of depth; and |gradient of depth| a pixel
  uint surface;  // rg32ui: packSurface(), depth along `forward` as a float's bits; 0: nothing is there
  uint previous_surface;
  uint albedos;   // rg32ui: packAlbedo() of the diffuse and of the specular directional albedo; 0: nothing is there
  uint emission;  // rgba16f: light that the camera sees without a scattering
  uint diffuse;   // rgba16f: this tick's light by the first vertex's diffuse lobe, over its albedo; a: 1, or 0 where it
                  // was dropped
  uint specular;  // rgba16f: the same of its specular lobe
  uint integrated[2];  // rgba16f: mean over ticks; a: standard deviation of that mean's luminance; diffuse, specular
  uint filtered[2];    // rgba16f: the same behind the first filter, which the next tick goes on from
  uint moments;        // rgba16f: of a sample's luminance: mean and standard deviation, diffuse then specular
  uint previous_moments;
  uint samples;  // rg16f: in the history; diffuse, specular
  uint previous_samples;
};

// What may be shown in the picture's place, as plain numbers.
HELIO_CONSTANT kInspectNothing = 0u;
HELIO_CONSTANT kInspectMotion = 1u;      // to the tick before: pixels to the right, pixels down, metres of depth
HELIO_CONSTANT kInspectPosition = 2u;    // of the first surface, world space, metres
HELIO_CONSTANT kInspectBefore = 3u;      // where that point of the surface was in the tick before, world space, metres
HELIO_CONSTANT kInspectUnfiltered = 4u;  // this tick's diffuse and specular light, modulated and added up
HELIO_CONSTANT kInspectDiffuse = 5u;     // mean over ticks, demodulated
HELIO_CONSTANT kInspectSpecular = 6u;
HELIO_CONSTANT kInspectSamples = 7u;  // in the history: diffuse, specular
HELIO_CONSTANT kInspects = 8u;

HELIO_SHARED_END
#endif
