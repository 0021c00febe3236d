// glTF 2.0 import through tinygltf, with every accessor checked before it is read.
#pragma once

#include <cstdint>
#include <filesystem>

#include "base/result.h"
#include "scene/import_report.h"
#include "scene/scene.h"

namespace helio::scene {

struct GltfOptions {
  uint64_t max_triangles = 50'000'000;
  uint64_t max_instances = 1'000'000;
  uint32_t max_texture_size = 16'384;              ///< edge length in texels
  uint64_t max_texture_bytes = uint64_t{4} << 30;  ///< of all textures together, decoded
};

/// Reads a .gltf or .glb file. Every mesh with triangles becomes a prefab that users can build (strips and fans are
/// converted, points and lines left out), every node with one a placement (or as many as EXT_mesh_gpu_instancing says),
/// every perspective camera a named camera; a file without cameras gets one, "overview". The light is a late morning,
/// glTF has none; punctual lights come on top. Surfaces are opaque and two-sided. Read: gltf_extensions.h. Left out:
/// skins, animations, morph targets, alpha, occlusion. Files are opened in the model's folder and below only.
/// Logs a summary and one line for everything left out; `report`, if given, gets the same for programs.
/// Errors (with the path and what in the file is wrong): not_found; invalid: unreadable, malformed, out-of-range
/// accessors, nodes that are no forest, numbers that are not finite, no triangles; unsupported: a required extension
/// that is not known (named); limit: those of the options, 1,024 levels of nodes, files of 4 GiB.
Result<ScenePtr> loadGltf(const std::filesystem::path& file, const GltfOptions& options = {},
                          ImportReport* report = nullptr);

}  // namespace helio::scene
