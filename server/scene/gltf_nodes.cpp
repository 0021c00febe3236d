#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>
#include <glm/gtc/quaternion.hpp>

#include "scene/gltf_import.h"

namespace helio::scene {
namespace {

constexpr uint32_t kMaxDepth = 1024;
constexpr int kNoParent = -1;

Error badNode(size_t node, const char* member, const std::string& why) {
  const std::string field = fmt::format("nodes[{}]{}", node, member);
  return invalid(field, "", fmt::format("{} {}", field, why));
}

/// A node's map into its parent's space.
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
  glm::dmat4 m(1.0);
  if (!node.rotation.empty()) {
    const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (!(glm::length(q) > 1e-12)) return badNode(index, ".rotation", "is a quaternion of length zero");
    m = glm::mat4_cast(glm::normalize(q));
  }
  for (int axis = 0; !node.scale.empty() && axis < 3; ++axis) m[axis] *= node.scale[static_cast<size_t>(axis)];
  if (!node.translation.empty()) m[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1.0);
  return m;
}

class NodeImporter {
 public:
  NodeImporter(const tinygltf::Model& model, const std::vector<uint32_t>& prefab_of_mesh, Scene& scene)
      : model_(model), prefab_of_mesh_(prefab_of_mesh), scene_(scene) {}

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
      if (Result<void> placed = place(node, visit.node, global); !placed) return placed;
      push(node.children, global);
    }
    if (zero_scaled_ > 0) spdlog::warn("glTF: {} nodes are scaled to a point and are left out", zero_scaled_);
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

  Result<void> place(const tinygltf::Node& node, size_t index, const glm::dmat4& global) {
    const glm::mat4x3 transform(global);
    for (int column = 0; column < 4; ++column) {
      const glm::vec3& v = transform[column];
      if (std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)) continue;
      return badNode(index, "", "has a transform that is not finite");
    }
    if (node.mesh >= 0 && prefab_of_mesh_[static_cast<size_t>(node.mesh)] != kNone) {
      const glm::vec3 zero(0.0f);
      if (transform[0] == zero && transform[1] == zero && transform[2] == zero) {
        ++zero_scaled_;
      } else {
        scene_.placements.push_back({prefab_of_mesh_[static_cast<size_t>(node.mesh)], transform});
      }
    }
    return node.camera >= 0 ? addCamera(node, index, transform) : Result<void>{};
  }

  Result<void> addCamera(const tinygltf::Node& node, size_t index, const glm::mat4x3& transform) {
    const tinygltf::Camera& from = model_.cameras[static_cast<size_t>(node.camera)];
    std::string name = !from.name.empty()   ? from.name
                       : !node.name.empty() ? node.name
                                            : fmt::format("camera_{}", node.camera);
    if (from.type != "perspective") {
      spdlog::warn("glTF: camera \"{}\" is left out: only perspective cameras are supported", name);
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

  const tinygltf::Model& model_;
  const std::vector<uint32_t>& prefab_of_mesh_;
  Scene& scene_;
  std::vector<int> parent_;
  UniqueNames names_;
  uint64_t zero_scaled_ = 0;
};

}  // namespace

Result<void> importNodes(const tinygltf::Model& model, const std::vector<uint32_t>& prefab_of_mesh, Scene& scene) {
  return NodeImporter(model, prefab_of_mesh, scene).import();
}

}  // namespace helio::scene
