#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>

#include <spdlog/fmt/fmt.h>
#include <glm/gtc/quaternion.hpp>

#include "scene/deform.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_extensions.h"
#include "scene/gltf_import.h"

namespace helio::scene {
namespace {

constexpr uint32_t kMaxDepth = 1024;
constexpr int kNoParent = -1;

Error badNode(size_t node, const char* member, const std::string& why) {
  const std::string field = fmt::format("nodes[{}]{}", node, member);
  return invalid(field, "", fmt::format("{} {}", field, why));
}

glm::dmat4 compose(const glm::dvec3& translation, const glm::dquat& rotation, const glm::dvec3& scale) {
  glm::dmat4 m = glm::mat4_cast(glm::normalize(rotation));
  for (int axis = 0; axis < 3; ++axis) m[axis] *= scale[axis];
  m[3] = glm::dvec4(translation, 1.0);
  return m;
}

bool isRotation(const glm::dquat& q) { return glm::length(q) > 1e-12; }

}  // namespace

Result<glm::dmat4> localTransform(const tinygltf::Node& node, size_t index) {
  if (!node.matrix.empty()) {
    glm::dmat4 m;
    for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<size_t>(i)];
    constexpr double kTolerance = 1e-6;
    if (glm::length(glm::dvec4(m[0][3], m[1][3], m[2][3], m[3][3] - 1.0)) > kTolerance) {
      return badNode(index, ".matrix", "is not affine: its last row must be 0 0 0 1");
    }
    return m;
  }
  const auto vec3 = [](const std::vector<double>& v, double fallback) {
    return v.empty() ? glm::dvec3(fallback) : glm::dvec3(v[0], v[1], v[2]);
  };
  glm::dquat rotation(1.0, 0.0, 0.0, 0.0);
  if (!node.rotation.empty())
    rotation = glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
  if (!isRotation(rotation)) return badNode(index, ".rotation", "is a quaternion of length zero");
  return compose(vec3(node.translation, 0.0), rotation, vec3(node.scale, 1.0));
}

namespace {

/// The maps of EXT_mesh_gpu_instancing's instances into the node's space; without the extension one, the identity.
Result<std::vector<glm::dmat4>> instancesOf(const GltfImport& import, const tinygltf::Node& node, size_t index) {
  const auto extension = node.extensions.find(kGpuInstancing);
  if (extension == node.extensions.end()) return std::vector<glm::dmat4>(1, glm::dmat4(1.0));
  const std::string at = fmt::format("nodes[{}].extensions.{}.attributes", index, kGpuInstancing);
  const tinygltf::Value& attributes = extension->second.Get("attributes");

  // All attributes have an element for each instance.
  std::vector<AccessorView> views;
  for (const std::string& name : attributes.Keys()) {
    const Result<AccessorView> view = viewAccessor(import.model, attributes.Get(name).GetNumberAsInt());
    if (!view) return view.error();
    if (!views.empty() && view->count != views.front().count) {
      const std::string field = fmt::format("{}.{}", at, name);
      return invalid(field, fmt::format("{}", view->count),
                     fmt::format("{} has {} elements, {} has {}: every instance needs one of each", field, view->count,
                                 views.front().name, views.front().count));
    }
    views.push_back(*view);
  }
  if (views.empty()) return invalid(at, "{}", at + " is empty: it must hold TRANSLATION, ROTATION or SCALE");
  const size_t count = views.front().count, most = import.options.max_instances;
  if (count > most) {
    return Error{ErrorKind::limit, fmt::format("{} makes {} instances, at most {} are allowed", at, count, most), at,
                 fmt::format("{}", count), fmt::format("{}", most)};
  }

  std::vector<uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  std::vector<glm::vec3> translations(count, glm::vec3(0.0f)), scales(count, glm::vec3(1.0f));
  std::vector<glm::vec4> rotations(count, glm::vec4(0.0f, 0.0f, 0.0f, 1.0f));  // x, y, z, w
  const std::vector<std::string> names = attributes.Keys();
  for (size_t i = 0; i < names.size(); ++i) {
    std::optional<Error> error;
    const auto store = [&error](auto read, auto& values) {
      if (read) {
        values = std::move(*read);
      } else {
        error = read.error();
      }
    };
    if (names[i] == "TRANSLATION") store(readVec3(views[i], all, Integers::none), translations);
    if (names[i] == "ROTATION") store(readVec4(views[i], all, Integers::normalized_signed), rotations);
    if (names[i] == "SCALE") store(readVec3(views[i], all, Integers::none), scales);
    if (error) return *error;
  }
  std::vector<glm::dmat4> instances;
  instances.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const glm::dquat rotation(rotations[i].w, rotations[i].x, rotations[i].y, rotations[i].z);
    if (!isRotation(rotation)) {
      const std::string field = fmt::format("{}.ROTATION[{}]", at, i);
      return invalid(field, "0 0 0 0", field + " is a quaternion of length zero");
    }
    instances.push_back(compose(translations[i], rotation, scales[i]));
  }
  return instances;
}

/// The prefabs of meshes that move otherwise in one node than in another.
class RiggedPrefabs {
 public:
  RiggedPrefabs(GltfImport& import, const std::vector<uint32_t>& base) : scene_(import.scene), base_(base) {
    for (const Prefab& prefab : scene_.prefabs) names_.take(prefab.name);
  }

  /// The prefab of a mesh of the file, moved as `rigged` says: the mesh's own for the first, others for further ones.
  /// Errors: a vertex that hangs on a joint which the skin has not.
  Result<uint32_t> prefabOf(size_t mesh, const RiggedNode& rigged, size_t node) {
    const Key key{mesh, rigged.rig, rigged.node};
    if (const auto found = made_.find(key); found != made_.end()) return found->second;
    uint32_t prefab = base_[mesh];
    if (rigged.rig == kNone) {
      // It stands still here: without what would make it move.
      if (scene_.meshes[scene_.prefabs[prefab].mesh].deforms()) prefab = standing(prefab);
      return made_[key] = prefab;
    }
    Mesh& moved = scene_.meshes[scene_.prefabs[prefab].mesh];
    const Rig& rig = scene_.rigs[rigged.rig];
    if (rigged.node != kNone) {
      if (!moved.skin.empty()) moved.skin.clear();
    } else {
      for (const VertexSkin& skin : moved.skin)
        for (int c = 0; c < 4; ++c)
          if (skin.weights[c] > 0.0f && skin.joints[c] >= rig.joints.size())
            return badNode(node, ".skin",
                           fmt::format("has {} joints, but a vertex of its mesh hangs on joint {}", rig.joints.size(),
                                       skin.joints[c]));
      if (moved.skin.empty()) moved.skin.resize(moved.positions.size());
    }
    if (moved.deforms()) moved.bounds.grow(boundsOverClips(moved, rig));
    if (!claimed_.insert(prefab).second) {
      Prefab copy = scene_.prefabs[prefab];
      copy.name = names_.take(copy.name);
      prefab = static_cast<uint32_t>(scene_.prefabs.size());
      scene_.prefabs.push_back(std::move(copy));
    }
    scene_.prefabs[prefab].rig = rigged.rig;
    scene_.prefabs[prefab].node = rigged.node;
    // What the file has further clips for can be built playing them.
    for (uint32_t clip = 1; clip < rig.clips.size(); ++clip) {
      Prefab other = scene_.prefabs[prefab];
      other.name = names_.take(other.name + ":" + rig.clips[clip].name);
      other.clip = other.travel_clip = clip;
      scene_.prefabs.push_back(std::move(other));
    }
    return made_[key] = prefab;
  }

  /// What nothing moves loses what it could be moved by.
  void finish() {
    for (const uint32_t prefab : base_) {
      if (prefab == kNone || claimed_.count(prefab) != 0) continue;
      Mesh& mesh = scene_.meshes[scene_.prefabs[prefab].mesh];
      mesh.skin.clear();
      mesh.morph_targets.clear();
    }
  }

 private:
  using Key = std::tuple<size_t, uint32_t, uint32_t>;

  uint32_t standing(uint32_t prefab) {
    Mesh mesh = scene_.meshes[scene_.prefabs[prefab].mesh];
    mesh.skin.clear();
    mesh.morph_targets.clear();
    mesh.name += " (still)";
    Prefab copy{names_.take(scene_.prefabs[prefab].name), scene_.prefabs[prefab].category,
                static_cast<uint32_t>(scene_.meshes.size()), true};
    scene_.meshes.push_back(std::move(mesh));
    scene_.prefabs.push_back(std::move(copy));
    return static_cast<uint32_t>(scene_.prefabs.size() - 1);
  }

  Scene& scene_;
  const std::vector<uint32_t>& base_;
  UniqueNames names_;
  std::map<Key, uint32_t> made_;
  std::set<uint32_t> claimed_;
};

class NodeImporter {
 public:
  NodeImporter(GltfImport& import, const std::vector<uint32_t>& prefab_of_mesh)
      : import_(import),
        model_(import.model),
        scene_(import.scene),
        prefabs_(import, prefab_of_mesh),
        prefab_of_mesh_(prefab_of_mesh),
        rigs_(import, parent_) {}

  Result<void> import() {
    if (Result<void> forest = checkForest(); !forest) return forest;
    const Result<std::vector<int>> roots = sceneRoots();
    if (!roots) return roots.error();

    struct Visit {
      size_t node;
      glm::dmat4 parent;
    };
    std::vector<Visit> stack;  // not recursion: how deep it goes is the file's choice
    const auto push = [&stack](const std::vector<int>& nodes, const glm::dmat4& parent) {
      for (size_t i = nodes.size(); i-- > 0;) stack.push_back({static_cast<size_t>(nodes[i]), parent});
    };
    push(*roots, glm::dmat4(1.0));
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const tinygltf::Node& node = model_.nodes[visit.node];
      const Result<glm::dmat4> local = localTransform(node, visit.node);
      if (!local) return local.error();
      const glm::dmat4 global = visit.parent * *local;
      if (Result<void> done = addNode(node, visit.node, global); !done) return done;
      push(node.children, global);
    }
    prefabs_.finish();
    return {};
  }

 private:
  /// Every node has at most one parent, and every chain of parents ends, soon enough.
  Result<void> checkForest() {
    parent_.assign(model_.nodes.size(), kNoParent);
    for (size_t i = 0; i < model_.nodes.size(); ++i) {
      for (int child : model_.nodes[i].children) {
        int& parent = parent_[static_cast<size_t>(child)];
        if (parent != kNoParent) {
          return badNode(
              static_cast<size_t>(child), "",
              fmt::format("is a child of nodes[{}] and again of nodes[{}]: a node has one parent", parent, i));
        }
        parent = static_cast<int>(i);
      }
    }

    std::vector<std::pair<size_t, uint32_t>> stack;  // node, depth
    for (size_t i = 0; i < parent_.size(); ++i) {
      if (parent_[i] == kNoParent) stack.emplace_back(i, 1);
    }
    std::vector<bool> has_root(model_.nodes.size(), false);
    while (!stack.empty()) {
      const auto [node, depth] = stack.back();
      stack.pop_back();
      has_root[node] = true;
      if (depth > kMaxDepth) {
        return Error{ErrorKind::limit, fmt::format("nodes[{}] lies more than {} levels deep", node, kMaxDepth),
                     fmt::format("nodes[{}]", node), fmt::format("{}", depth), fmt::format("{}", kMaxDepth)};
      }
      for (int child : model_.nodes[node].children) stack.emplace_back(static_cast<size_t>(child), depth + 1);
    }
    const auto lost = std::find(has_root.begin(), has_root.end(), false);
    if (lost == has_root.end()) return {};
    return badNode(static_cast<size_t>(lost - has_root.begin()), "", "is its own ancestor: the nodes form a cycle");
  }

  /// The roots of the file's scene; without scenes, of all nodes.
  Result<std::vector<int>> sceneRoots() const {
    std::vector<int> roots;
    if (model_.scenes.empty()) {
      for (size_t i = 0; i < parent_.size(); ++i) {
        if (parent_[i] == kNoParent) roots.push_back(static_cast<int>(i));
      }
      return roots;
    }
    const auto index = static_cast<size_t>(std::max(model_.defaultScene, 0));
    std::vector<bool> listed(model_.nodes.size(), false);
    for (int root : model_.scenes[index].nodes) {
      const auto node = static_cast<size_t>(root);
      if (listed[node] || parent_[node] != kNoParent) {
        return badNode(node, "",
                       fmt::format("is listed in scenes[{}].nodes, but {}", index,
                                   listed[node] ? "twice" : "it is the child of another node"));
      }
      listed[node] = true;
      roots.push_back(root);
    }
    return roots;
  }

  Result<void> addNode(const tinygltf::Node& node, size_t index, const glm::dmat4& global) {
    const Result<glm::mat4x3> transform = finite(global, index);
    if (!transform) return transform.error();
    if (node.mesh >= 0 && prefab_of_mesh_[static_cast<size_t>(node.mesh)] != kNone) {
      if (Result<void> placed = place(node, index, global); !placed) return placed;
    }
    if (const auto light = node.extensions.find(kLightsPunctual); light != node.extensions.end()) {
      const auto which = static_cast<size_t>(light->second.Get("light").GetNumberAsInt());
      if (Result<void> added = addLight(model_.lights[which], node.name, index, *transform); !added) return added;
    }
    return node.camera >= 0 ? addCamera(node, index, *transform) : Result<void>{};
  }

  static Result<glm::mat4x3> finite(const glm::dmat4& global, size_t index) {
    const glm::mat4x3 transform(global);
    for (int column = 0; column < 4; ++column) {
      const glm::vec3& v = transform[column];
      if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) continue;
      return badNode(index, "", "has a transform that is not finite");
    }
    return transform;
  }

  Result<void> place(const tinygltf::Node& node, size_t index, const glm::dmat4& global) {
    const Result<std::vector<glm::dmat4>> instances = instancesOf(import_, node, index);
    if (!instances) return instances.error();
    const size_t most = import_.options.max_instances, wanted = scene_.placements.size() + instances->size();
    if (wanted > most) {
      return Error{
          ErrorKind::limit,
          fmt::format("nodes[{}] brings the model to {} instances, at most {} are allowed", index, wanted, most),
          fmt::format("nodes[{}]", index), fmt::format("{}", wanted), fmt::format("{}", most)};
    }
    const uint32_t base = prefab_of_mesh_[static_cast<size_t>(node.mesh)];
    RiggedNode rigged{kNone, kNone, global};
    if (node.extensions.count(kGpuInstancing) == 0) {
      const auto found = rigs_.rigOf(index, global, scene_.meshes[scene_.prefabs[base].mesh].morph_targets.size());
      if (!found) return found.error();
      rigged = *found;
    }
    const Result<uint32_t> prefab = prefabs_.prefabOf(static_cast<size_t>(node.mesh), rigged, index);
    if (!prefab) return prefab.error();
    for (const glm::dmat4& instance : *instances) {
      const Result<glm::mat4x3> transform = finite(rigged.placement * instance, index);
      if (!transform) return transform.error();
      const glm::vec3 zero(0.0f);
      if ((*transform)[0] == zero && (*transform)[1] == zero && (*transform)[2] == zero) {
        import_.report.ignore("instances scaled to a point", "they cannot be seen");
      } else {
        scene_.placements.push_back({*prefab, *transform});
      }
    }
    return {};
  }

  /// A light shines along its node's -z; scale does not touch it.
  Result<void> addLight(const tinygltf::Light& from, const std::string& node_name, size_t index,
                        const glm::mat4x3& transform) {
    PunctualLight light;
    light.name = from.name.empty() ? node_name : from.name;
    light.type = from.type == "directional" ? PunctualLight::Type::directional
                 : from.type == "spot"      ? PunctualLight::Type::spot
                                            : PunctualLight::Type::point;
    light.position = transform[3];
    if (light.type != PunctualLight::Type::point) {
      if (!(glm::length(transform[2]) > 0.0f))
        return badNode(index, "", "carries a light but its transform has no directions left");
      light.direction = -glm::normalize(transform[2]);
    }
    for (int c = 0; c < 3 && !from.color.empty(); ++c)
      light.color[c] = static_cast<float>(std::clamp(from.color[static_cast<size_t>(c)], 0.0, 1.0));
    light.intensity = static_cast<float>(from.intensity);
    if (from.range > 0.0) light.range = static_cast<float>(from.range);
    if (light.type == PunctualLight::Type::spot) {
      light.inner_cone = static_cast<float>(from.spot.innerConeAngle);
      light.outer_cone = static_cast<float>(from.spot.outerConeAngle);
    }
    scene_.lights.push_back(std::move(light));
    return {};
  }

  Result<void> addCamera(const tinygltf::Node& node, size_t index, const glm::mat4x3& transform) {
    const tinygltf::Camera& from = model_.cameras[static_cast<size_t>(node.camera)];
    std::string name = !from.name.empty()   ? from.name
                       : !node.name.empty() ? node.name
                                            : fmt::format("camera_{}", node.camera);
    if (from.type != "perspective") {
      import_.report.ignore("orthographic cameras", "only perspective cameras are supported");
      return {};
    }
    const double vfov = from.perspective.yfov;
    if (!(vfov > 0.0 && vfov < glm::pi<double>())) {
      const std::string field = fmt::format("cameras[{}].perspective.yfov", node.camera);
      return invalid(field, fmt::format("{}", vfov),
                     fmt::format("{} is {}: it must lie in (0, pi) radians", field, vfov));
    }
    const glm::vec3 forward = -transform[2], up = transform[1];
    if (!(glm::length(glm::cross(forward, up)) > 0.0f))
      return badNode(index, "", "carries a camera but its transform has no directions left");
    scene_.cameras.push_back({names_.take(name),
                              "from the model",
                              {transform[3], glm::normalize(forward), glm::normalize(up), static_cast<float>(vfov)},
                              scene_.environment});
    return {};
  }

  GltfImport& import_;
  const tinygltf::Model& model_;
  Scene& scene_;
  RiggedPrefabs prefabs_;
  const std::vector<uint32_t>& prefab_of_mesh_;
  std::vector<int> parent_;
  RigImporter rigs_;
  UniqueNames names_;
};

}  // namespace

Result<void> importNodes(GltfImport& import, const std::vector<uint32_t>& prefab_of_mesh) {
  return NodeImporter(import, prefab_of_mesh).import();
}

}  // namespace helio::scene
