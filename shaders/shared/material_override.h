// What a viewer may put in the place of all materials, to look at one thing at a time.
#ifndef HELIO_SHARED_MATERIAL_OVERRIDE_H
#define HELIO_SHARED_MATERIAL_OVERRIDE_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kMaterialsAsAuthored = 0u;
// Lit by the scene's light.
HELIO_CONSTANT kMaterialsLambert = 1u;  // two-sided Lambert of base colour, and emission; no normal maps
HELIO_CONSTANT kMaterialsWhite = 2u;    // Lambert of albedo kWhiteAlbedo, and emission
// Shown as they are, from here on: the camera's first hit alone, without light.
HELIO_CONSTANT kShowAlbedo = 3u;              // base colour, linear
HELIO_CONSTANT kShowRoughnessMetallic = 4u;   // green and blue, as in glTF's texture
HELIO_CONSTANT kShowEmission = 5u;            // radiance, linear
HELIO_CONSTANT kShowNormals = 6u;             // 0.5 + 0.5 n of the shading normal, world space, on the viewer's side
HELIO_CONSTANT kShowGeometricNormals = 7u;    // the same of the triangle's
HELIO_CONSTANT kShowTextureCoordinates = 8u;  // the fractions of u and v of channel 0, red and green
HELIO_CONSTANT kShowInstances = 9u;           // a colour an instance
HELIO_CONSTANT kShowMaterials = 10u;          // a colour a material
HELIO_CONSTANT kMaterialOverrides = 11u;

HELIO_SHARED_END
#endif
