// What moves: rigs with their clips, as glTF has them, and routes through the world. A pose is a function of a time and
// of nothing else.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace helio::scene {

enum class Interpolation : uint32_t { step, linear, cubic_spline };
enum class ChannelTarget : uint32_t { translation, rotation, scale, weights };

/// How one property of a node, or all of a rig's morph weights, runs over time [glTF 2.0, §3.11].
struct Channel {
  uint32_t node = 0;  ///< of the rig; not used by weights
  ChannelTarget target = ChannelTarget::translation;
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> times;  ///< seconds, rising, at least one
  /// 3 (translation, scale), 4 (rotation x y z w) or the rig's `weights` a key; a cubic spline has an in-tangent, a
  /// value and an out-tangent a key.
  std::vector<float> values;
};

/// A motion that starts again after `duration`. What has no channel rests.
struct Clip {
  std::string name;
  float duration = 0.0f;  ///< seconds; 0: a pose
  std::vector<Channel> channels;
};

/// A node of a rig: its map into its parent's space. `rest` is used as it is while no channel moves the node.
struct RigNode {
  uint32_t parent = 0xffffffffu;  ///< a smaller index, or kNone
  glm::mat4x3 rest{1.0f};
  glm::vec3 translation{0.0f};
  glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
  glm::vec3 scale{1.0f};
};

/// What the joint indices of a mesh mean.
struct Joint {
  uint32_t node = 0;
  glm::mat4x3 inverse_bind{1.0f};
};

/// Nodes that move together, parents before their children.
struct Rig {
  std::string name;
  std::vector<RigNode> nodes;
  std::vector<Joint> joints;   ///< of skinned meshes
  std::vector<float> weights;  ///< of morph targets, at rest
  std::vector<Clip> clips;     ///< at least one
};

/// A shape that is mixed into a mesh: what is added to positions and normals at weight 1. As many as the mesh has
/// vertices.
struct MorphTarget {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
};

/// Up to four joints of a vertex. Weights are 0 or more and sum to 1.
struct VertexSkin {
  glm::u16vec4 joints{0};
  glm::vec4 weights{1.0f, 0.0f, 0.0f, 0.0f};
};

/// A closed way through the world, corners rounded.
struct Route {
  std::vector<glm::vec3> points;  ///< metres; the last joins the first
  std::vector<float> lengths;     ///< along the way up to each point, and all of it: points.size() + 1

  explicit Route(std::vector<glm::vec3> way = {});
  float length() const { return lengths.empty() ? 0.0f : lengths.back(); }
  /// Where one is after `distance` metres, anywhere on the real line: columns x, y (up), z (ahead), position; upright.
  glm::mat4x3 at(double distance) const;

 private:
  glm::vec3 point(double distance) const;
};

/// The time within a clip at a time of the world: both begin at 0, and the clip begins anew after its duration.
double clipTime(double time, float duration);

/// The maps of all nodes into the rig's space at a time within the clip [glTF 2.0, §3.7.3, appendix C].
std::vector<glm::mat4x3> nodesAt(const Rig& rig, const Clip& clip, float time);
/// The joints' maps from the mesh's space at rest into the rig's space.
std::vector<glm::mat4x3> jointsAt(const Rig& rig, const Clip& clip, float time);
/// The weights of the morph targets.
std::vector<float> weightsAt(const Rig& rig, const Clip& clip, float time);

/// a * b of affine maps.
glm::mat4x3 concatenate(const glm::mat4x3& a, const glm::mat4x3& b);

}  // namespace helio::scene
