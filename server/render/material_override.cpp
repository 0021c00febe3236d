#include "render/material_override.h"

#include <algorithm>

namespace helio::render {

const std::vector<std::string>& materialOverrideNames() {
  static const std::vector<std::string> names{"none",
                                              "lambert",
                                              "white",
                                              "albedo",
                                              "roughness_metallic",
                                              "emission",
                                              "normals",
                                              "geometric_normals",
                                              "texture_coordinates",
                                              "instances",
                                              "materials"};
  return names;
}

std::optional<MaterialOverride> materialOverride(const std::string& name) {
  const auto& names = materialOverrideNames();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<MaterialOverride>(found - names.begin());
}

}  // namespace helio::render
