// glTF 2.0 import through tinygltf, with every accessor checked before it is read.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "scene/scene.h"

namespace helio::scene {

struct GltfOptions {
  bool lambert = false;  ///< every surface becomes two-sided Lambert with base colour and emission (reference images)
  uint64_t max_triangles = 50'000'000;
  uint32_t max_texture_size = 16'384;  ///< edge length in texels
};

/// Reads a .gltf or .glb file. Every mesh becomes a prefab, every node with a mesh a placement.
/// Errors (invalid, with the path and what in the file is wrong): unreadable, malformed, out-of-range accessors, a required
/// extension that is not known (named), no triangles, limits exceeded (limit).
Result<ScenePtr> loadGltf(const std::filesystem::path& file, const GltfOptions& options = {});

}  // namespace helio::scene
