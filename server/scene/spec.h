// A picture as a file asks for it: scene, light, camera, size, samples. The format of reference images.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "scene/scene.h"

namespace helio::scene {

/// What to render. `scene` has the light and the one camera that the file names.
struct Spec {
  std::string name;
  ScenePtr scene;
  uint32_t width = 0, height = 0;
  uint32_t samples = 0;  ///< a pixel
  uint32_t bounces = 0;
  bool lambert = false;  ///< materials: every surface two-sided Lambert with base colour and emission
};

/// Reads a JSON object {name, gltf: path from the file's folder or null, materials: "gltf" | "lambert", width, height,
/// spp, max_bounces, camera: {position, target, vfov_deg}, suns: [{direction, irradiance, angular_diameter_deg}], sky:
/// {type: "constant", radiance} or {type: "gradient", zenith, ground}}. Other keys say where a picture comes from and
/// are left alone. Errors (with path and field): not_found, invalid; unsupported: more than one sun; the model's own.
Result<Spec> loadSpec(const std::filesystem::path& file);

}  // namespace helio::scene
