// glTF 2.0 import through tinygltf, with every accessor checked before it is read.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/result.h"
#include "scene/scene.h"

namespace helio::scene {

struct GltfOptions {
  bool lambert = false;  ///< every surface becomes two-sided Lambert with base colour and emission (reference images)
  uint64_t max_triangles = 50'000'000;
  uint32_t max_texture_size = 16'384;              ///< edge length in texels
  uint64_t max_texture_bytes = uint64_t{4} << 30;  ///< of all textures together, decoded
};

/// Reads a .gltf or .glb file. Every mesh with triangles becomes a prefab that users can build (strips and fans are
/// converted, points and lines left out), every node with one a placement, every perspective camera a named camera; a
/// file without cameras gets one, "overview". The light is a late morning, glTF has none. Left out: skins, animations,
/// alpha, uv sets other than 0. Files are opened in the model's folder and below only. Errors (with the path and what
/// in the file is wrong): not_found; invalid: unreadable, malformed, out-of-range accessors, nodes that are no forest,
/// numbers that are not finite, no triangles; unsupported: a required extension that is not known (named), sparse
/// accessors; limit: those of the options, 1,024 levels of nodes, files of 4 GiB.
Result<ScenePtr> loadGltf(const std::filesystem::path& file, const GltfOptions& options = {});

}  // namespace helio::scene
