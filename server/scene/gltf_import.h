// The steps of an import, in the order in which gltf.cpp takes them. Errors come without the file's name.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "base/result.h"
#include "scene/gltf.h"
#include "scene/gltf_model.h"
#include "scene/scene.h"

namespace helio::scene {

/// Gives every name once: the second "house" becomes "house_2".
class UniqueNames {
 public:
  std::string take(const std::string& wanted);

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, uint32_t> copies_of_;
};

/// Appends the file's materials (the same indices), one more for primitives without any, and the textures that they
/// use. The same image used both as colour and as data becomes two textures. Errors: an image that is missing, damaged
/// or beyond a limit; a factor that is not finite.
Result<void> importMaterials(const tinygltf::Model& model, const GltfOptions& options, Scene& scene);

/// Appends a mesh and a prefab for every mesh of the file that has triangles; points and lines are left out. Returns
/// the prefab of each mesh of the file, or kNone. Errors: accessors (gltf_accessor.h), a count of corners that makes no
/// triangles, more triangles than options.max_triangles.
Result<std::vector<uint32_t>> importMeshes(const tinygltf::Model& model, const GltfOptions& options, Scene& scene);

/// Appends a placement for every node of the file's scene whose mesh has a prefab, and a camera for every perspective
/// camera. Errors: nodes that are no forest, nested too deep, or whose transform is not finite or has no rotation.
Result<void> importNodes(const tinygltf::Model& model, const std::vector<uint32_t>& prefab_of_mesh, Scene& scene);

}  // namespace helio::scene
