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
#include "scene/import_report.h"
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

/// What every step reads and writes.
struct GltfImport {
  const tinygltf::Model& model;
  const GltfOptions& options;
  Scene& scene;
  ImportReport& report;

  bool uses(const char* extension) const;  ///< the file says so
};

/// Where texture coordinates of a channel come from: uv = scale, then rotation, then offset of the file's set
/// [KHR_texture_transform].
struct UvMapping {
  int set = 0;  ///< TEXCOORD_n
  glm::vec2 offset{0.0f};
  float rotation = 0.0f;  ///< radians, counter-clockwise with v upwards
  glm::vec2 scale{1.0f};

  glm::vec2 operator()(const glm::vec2& uv) const;
  bool identity() const { return offset == glm::vec2(0.0f) && rotation == 0.0f && scale == glm::vec2(1.0f); }
  bool operator==(const UvMapping&) const = default;
};

/// The channels of texture coordinates that a material's textures read, at least one.
using UvChannels = std::vector<UvMapping>;

/// Appends the file's materials (the same indices), one more for primitives without any, and the textures that they
/// use. The same image used both as colour and as data becomes two textures. Returns each material's channels: texture
/// transforms are not done by shaders but once, when meshes are read. Errors: an image that is missing, damaged or
/// beyond a limit; a factor that is not finite.
Result<std::vector<UvChannels>> importMaterials(GltfImport& import);

/// Appends a mesh and a prefab for every mesh of the file that has triangles; points and lines are left out. Returns
/// the prefab of each mesh of the file, or kNone. Errors: accessors (gltf_accessor.h), a count of corners that makes no
/// triangles, more triangles than options.max_triangles.
Result<std::vector<uint32_t>> importMeshes(GltfImport& import, const std::vector<UvChannels>& channels_of_material);

/// Appends a placement for every node of the file's scene whose mesh has a prefab, or one for each of its instances, a
/// camera for every perspective camera, and the punctual lights. Errors: nodes that are no forest, nested too deep, or
/// whose transform is not finite or has no rotation; instances whose attributes differ in count, or more than
/// options.max_instances.
Result<void> importNodes(GltfImport& import, const std::vector<uint32_t>& prefab_of_mesh);

}  // namespace helio::scene
