// Specialisation constants: one a registered effect, in the registry's order (effects/registry.h). A shader is compiled
// for exactly what the scene calls for.
#ifndef HELIO_EFFECTS_GLSL
#define HELIO_EFFECTS_GLSL
#include "shared/material_override.h"
#include "shared/technique.h"

layout(constant_id = 0) const bool kTextures = true;
layout(constant_id = 1) const bool kNormalMaps = true;
layout(constant_id = 2) const bool kEmissiveTriangles = true;
layout(constant_id = 3) const bool kSun = true;
layout(constant_id = 4) const bool kSkyGradient = true;
layout(constant_id = 5) const bool kMirrors = true;
layout(constant_id = 6) const bool kUvChannels = true;
layout(constant_id = 7) const bool kVertexColors = true;
layout(constant_id = 8) const bool kSpecular = true;
layout(constant_id = 9) const bool kUnlit = true;
layout(constant_id = 10) const bool kAlphaMasks = true;
layout(constant_id = 11) const bool kPunctualLights = true;
layout(constant_id = 12) const bool kDeforming = true;

// What stands in the place of all materials: shared/material_override.h.
layout(constant_id = 40) const uint kMaterials = kMaterialsAsAuthored;

// What only some views ask for.
layout(constant_id = 41) const bool kSkySampling = true;
layout(constant_id = 42) const bool kMultipleScattering = true;
layout(constant_id = 43) const bool kManyLamps = false;
// 44: kSunShadow (lib/shadow_map.glsl).
// Rays count whom they meet (shared/lipac.h).
layout(constant_id = 45) const bool kCountHits = false;
// Boxes are any-hit geometry (accel::BoxHits).
layout(constant_id = 49) const bool kAnyHitBoxes = false;
// 48: kReshades (path_trace.rgen).
layout(constant_id = 50) const uint kTechnique = kTechniquePathTraced;
layout(constant_id = 51) const uint kAmbient = kAmbientNone;
// The camera has a lens that may be wider than a point.
layout(constant_id = 52) const bool kLens = true;
// Shadow rays tell the light grid which lamps are seen (shared/light_lists.h).
layout(constant_id = 53) const bool kLightFeedback = false;
// Further paths of the tick, of pixels that are listed (shared/extra_samples.h).
layout(constant_id = 57) const bool kFurther = false;
layout(constant_id = 54) const uint kIndirectRate = kIndirectFull;
// Denoisers are told how far the next surface is.
layout(constant_id = 55) const bool kHitDistances = false;
// Light by the first vertex's diffuse and specular lobes is kept apart, without albedos (shared/history.h).
layout(constant_id = 46) const bool kSplit = false;
// Of that light the sun's, straight to the surface that a pixel shows, has its own way: as if nothing stood in it, and what stands there.
layout(constant_id = 58) const bool kSunApart = false;
// So has the sky's in the place of what was scattered diffusely.
layout(constant_id = 59) const bool kAmbientApart = false;

#endif
