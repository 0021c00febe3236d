// The steps of an import, in the order in which gltf.cpp takes them. Errors come without the file's name.
#pragma once

#include <cstdint>
#include <map>
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

/// A node's map into its parent's space. Errors: a matrix that is not affine, a rotation of length zero.
Result<glm::dmat4> localTransform(const tinygltf::Node& node, size_t index);

/// A node with a mesh, and what moves it.
struct RiggedNode {
  uint32_t rig = kNone;       ///< kNone: it stands still
  uint32_t node = kNone;      ///< of the rig, that carries the mesh; kNone: the mesh is skinned
  glm::dmat4 placement{1.0};  ///< where an instance of it stands for the file's scene
};

/// Makes the rigs of the nodes whose meshes move: those with a skin, below an animated node, or with morph targets that
/// are animated or have weights.
class RigImporter {
 public:
  /// `parent`: of each node, or -1; a forest.
  RigImporter(GltfImport& import, const std::vector<int>& parent) : import_(import), parent_(parent) {}

  /// Appends the node's rig to the scene, with a clip for every animation of the file that moves it. Errors: accessors,
  /// key times that do not rise, counts of keys and values that do not fit.
  Result<RiggedNode> rigOf(size_t node, const glm::dmat4& global, size_t morph_targets);

 private:
  std::vector<size_t> chainOf(const std::vector<size_t>& ends) const;
  Result<void> addJoints(const tinygltf::Skin& skin, size_t index, Rig& rig) const;
  Result<void> addClips(size_t mesh_node, Rig& rig) const;
  Result<Channel> channelOf(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& from,
                            const std::string& at, size_t weights) const;

  GltfImport& import_;
  const std::vector<int>& parent_;
  std::map<size_t, uint32_t> rig_node_;  // of the rig being made, by the file's node
  std::map<int, uint32_t> rig_of_skin_;  // of skinned meshes without morph targets
};

/// Appends a placement for every node of the file's scene whose mesh has a prefab, or one for each of its instances, a
/// camera for every perspective camera, and the punctual lights. Errors: nodes that are no forest, nested too deep, or
/// whose transform is not finite or has no rotation; instances whose attributes differ in count, or more than
/// options.max_instances.
Result<void> importNodes(GltfImport& import, const std::vector<uint32_t>& prefab_of_mesh);

}  // namespace helio::scene
