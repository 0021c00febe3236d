// What a viewer may put in the place of all materials. Numbers as in shaders/shared/material_override.h, which says
// what each shows, and as in the protocol.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/material_override.h"

namespace helio::render {

enum class MaterialOverride : uint32_t {
  none = shared::kMaterialsAsAuthored,
  lambert = shared::kMaterialsLambert,
  white = shared::kMaterialsWhite,
  albedo = shared::kShowAlbedo,
  roughness_metallic = shared::kShowRoughnessMetallic,
  emission = shared::kShowEmission,
  normals = shared::kShowNormals,
  geometric_normals = shared::kShowGeometricNormals,
  texture_coordinates = shared::kShowTextureCoordinates,
  instances = shared::kShowInstances,
  materials = shared::kShowMaterials,
};

/// "none", "lambert", ... in the order of the numbers.
const std::vector<std::string>& materialOverrideNames();
/// By name; nothing for names that there are not.
std::optional<MaterialOverride> materialOverride(const std::string& name);

/// The picture is a property of what the camera sees, not light: no exposure, no tone curve.
inline bool showsProperty(MaterialOverride materials) {
  return static_cast<uint32_t>(materials) >= shared::kShowAlbedo;
}
/// A property that is a colour, and so encoded as one in the 8-bit picture; others are stored as they are, 0 to 1.
inline bool showsColor(MaterialOverride materials) {
  return materials == MaterialOverride::albedo || materials == MaterialOverride::emission;
}

}  // namespace helio::render
