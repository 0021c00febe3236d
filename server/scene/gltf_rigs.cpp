#include <algorithm>
#include <cmath>
#include <iterator>

#include <spdlog/fmt/fmt.h>

#include "scene/gltf_accessor.h"
#include "scene/gltf_import.h"

namespace helio::scene {
namespace {

RigNode nodeOf(const tinygltf::Node& from, const glm::dmat4& local) {
  RigNode node;
  node.rest = glm::mat4x3(local);
  const auto vec3 = [](const std::vector<double>& v, float fallback) {
    return v.empty() ? glm::vec3(fallback) : glm::vec3(glm::dvec3(v[0], v[1], v[2]));
  };
  node.translation = vec3(from.translation, 0.0f);
  node.scale = vec3(from.scale, 1.0f);
  if (!from.rotation.empty()) {
    const auto r = [&from](size_t i) { return static_cast<float>(from.rotation[i]); };
    node.rotation = glm::quat(r(3), r(0), r(1), r(2));
  }
  return node;
}

Interpolation interpolationOf(const std::string& name) {
  if (name == "STEP") return Interpolation::step;
  return name == "CUBICSPLINE" ? Interpolation::cubic_spline : Interpolation::linear;
}

}  // namespace

std::vector<size_t> RigImporter::chainOf(const std::vector<size_t>& ends) const {
  std::map<size_t, size_t> depth_of;
  for (const size_t end : ends) {
    size_t depth = 0;
    for (int up = parent_[end]; up >= 0; up = parent_[static_cast<size_t>(up)]) ++depth;
    for (int node = static_cast<int>(end); node >= 0; node = parent_[static_cast<size_t>(node)])
      if (!depth_of.emplace(static_cast<size_t>(node), depth--).second) break;
  }
  std::vector<size_t> nodes;
  nodes.reserve(depth_of.size());
  for (const auto& [node, depth] : depth_of) nodes.push_back(node);
  std::stable_sort(nodes.begin(), nodes.end(), [&](size_t a, size_t b) { return depth_of[a] < depth_of[b]; });
  return nodes;
}

Result<void> RigImporter::addJoints(const tinygltf::Skin& skin, size_t index, Rig& rig) const {
  std::vector<float> inverse;
  if (skin.inverseBindMatrices >= 0) {
    const Result<AccessorView> view = viewAccessor(import_.model, skin.inverseBindMatrices);
    if (!view) return view.error();
    if (view->count < skin.joints.size()) {
      const std::string field = fmt::format("skins[{}].inverseBindMatrices", index);
      return invalid(field, fmt::format("{}", view->count),
                     fmt::format("{} holds {} matrices for {} joints", field, view->count, skin.joints.size()));
    }
    auto numbers = readNumbers(*view, TINYGLTF_TYPE_MAT4, Integers::none);
    if (!numbers) return numbers.error();
    inverse = std::move(*numbers);
  }
  for (size_t j = 0; j < skin.joints.size(); ++j) {
    Joint joint{rig_node_.at(static_cast<size_t>(skin.joints[j])), glm::mat4x3(1.0f)};
    for (int column = 0; column < 4 && !inverse.empty(); ++column)
      for (int row = 0; row < 3; ++row)
        joint.inverse_bind[column][row] = inverse[j * 16 + static_cast<size_t>(column * 4 + row)];
    rig.joints.push_back(joint);
  }
  return {};
}

Result<Channel> RigImporter::channelOf(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& from,
                                       const std::string& at, size_t weights) const {
  const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<size_t>(from.sampler)];
  Channel channel;
  channel.interpolation = interpolationOf(sampler.interpolation);
  channel.target = from.target_path == "translation" ? ChannelTarget::translation
                   : from.target_path == "rotation"  ? ChannelTarget::rotation
                   : from.target_path == "scale"     ? ChannelTarget::scale
                                                     : ChannelTarget::weights;
  const Result<AccessorView> input = viewAccessor(import_.model, sampler.input);
  if (!input) return input.error();
  auto times = readNumbers(*input, TINYGLTF_TYPE_SCALAR, Integers::none);
  if (!times) return times.error();
  for (size_t i = 0; i < times->size(); ++i) {
    const float time = (*times)[i];
    if (time >= 0.0f && (i == 0 || time > (*times)[i - 1])) continue;
    const std::string field = fmt::format("{}[{}]", input->name, i);
    return invalid(field, fmt::format("{}", time),
                   fmt::format("{} is {}: key times must be 0 or more, and rise", field, time));
  }
  const Result<AccessorView> output = viewAccessor(import_.model, sampler.output);
  if (!output) return output.error();
  const int type = channel.target == ChannelTarget::weights    ? TINYGLTF_TYPE_SCALAR
                   : channel.target == ChannelTarget::rotation ? TINYGLTF_TYPE_VEC4
                                                               : TINYGLTF_TYPE_VEC3;
  const bool whole = channel.target == ChannelTarget::translation || channel.target == ChannelTarget::scale;
  const Integers allowed = whole                                       ? Integers::none
                           : channel.target == ChannelTarget::rotation ? Integers::normalized_signed
                                                                       : Integers::normalized_unsigned;
  auto values = readNumbers(*output, type, allowed);
  if (!values) return values.error();
  const size_t parts = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
  const size_t wanted = times->size() * parts * (channel.target == ChannelTarget::weights ? weights : 1);
  if (output->count != wanted) {
    const std::string field = fmt::format("{}.samplers[{}].output", at, from.sampler);
    return invalid(field, fmt::format("{}", output->count),
                   fmt::format("{} has {} values, {} keys need {}", field, output->count, times->size(), wanted));
  }
  channel.times = std::move(*times);
  channel.values = std::move(*values);
  return channel;
}

Result<void> RigImporter::addClips(size_t mesh_node, Rig& rig) const {
  for (size_t a = 0; a < import_.model.animations.size(); ++a) {
    const tinygltf::Animation& animation = import_.model.animations[a];
    const std::string at = fmt::format("animations[{}]", a);
    Clip clip;
    clip.name = animation.name.empty() ? fmt::format("clip_{}", a) : animation.name;
    for (const tinygltf::AnimationChannel& from : animation.channels) {
      const bool of_weights = from.target_path == "weights";
      const auto node = from.target_node < 0 ? rig_node_.end() : rig_node_.find(static_cast<size_t>(from.target_node));
      if (of_weights ? static_cast<size_t>(std::max(from.target_node, 0)) != mesh_node || rig.weights.empty()
                     : node == rig_node_.end())
        continue;
      if (!of_weights && from.target_path != "translation" && from.target_path != "rotation" &&
          from.target_path != "scale") {
        import_.report.ignore("animated " + from.target_path, "only transforms and weights move");
        continue;
      }
      auto channel = channelOf(animation, from, at, rig.weights.size());
      if (!channel) return channel.error();
      if (!of_weights) channel->node = node->second;
      clip.duration = std::max(clip.duration, channel->times.back());
      clip.channels.push_back(std::move(*channel));
    }
    if (!clip.channels.empty()) rig.clips.push_back(std::move(clip));
  }
  return {};
}

Result<RiggedNode> RigImporter::rigOf(size_t index, const glm::dmat4& global, size_t morph_targets) {
  const tinygltf::Model& model = import_.model;
  const tinygltf::Node& node = model.nodes[index];
  const bool skinned = node.skin >= 0;
  const RiggedNode still{kNone, kNone, global};
  const bool shared = skinned && morph_targets == 0;
  if (const auto known = rig_of_skin_.find(node.skin); shared && known != rig_of_skin_.end())
    return RiggedNode{known->second, kNone, glm::dmat4(1.0)};

  Rig rig;
  rig.name = node.name.empty() ? fmt::format("rig_{}", index) : node.name;
  rig.weights.assign(morph_targets, 0.0f);
  const std::vector<double>& own =
      node.weights.empty() ? model.meshes[static_cast<size_t>(node.mesh)].weights : node.weights;
  std::transform(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(std::min(own.size(), morph_targets)),
                 rig.weights.begin(), [](double w) { return static_cast<float>(w); });

  std::vector<size_t> ends;
  if (skinned) {
    const std::vector<int>& joints = model.skins[static_cast<size_t>(node.skin)].joints;
    std::transform(joints.begin(), joints.end(), std::back_inserter(ends),
                   [](int n) { return static_cast<size_t>(n); });
  } else {
    ends = {index};
  }
  // A rigid mesh moves relative to where it is at rest, so that users find it where they build it.
  const bool relative = !skinned && std::isnormal(glm::determinant(global));
  rig_node_.clear();
  if (relative) {
    RigNode root;
    root.rest = glm::mat4x3(glm::inverse(global));
    rig.nodes.push_back(root);
  }
  for (const size_t n : chainOf(ends)) {
    const Result<glm::dmat4> local = localTransform(model.nodes[n], n);
    if (!local) return local.error();
    rig_node_[n] = static_cast<uint32_t>(rig.nodes.size());
    rig.nodes.push_back(nodeOf(model.nodes[n], *local));
    if (parent_[n] >= 0) rig.nodes.back().parent = rig_node_.at(static_cast<size_t>(parent_[n]));
    else if (relative) rig.nodes.back().parent = 0;
  }
  if (skinned) {
    if (auto done = addJoints(model.skins[static_cast<size_t>(node.skin)], static_cast<size_t>(node.skin), rig); !done)
      return done.error();
  }
  if (auto done = addClips(index, rig); !done) return done.error();
  const bool shaped = std::any_of(rig.weights.begin(), rig.weights.end(), [](float w) { return w != 0.0f; });
  if (rig.clips.empty()) {
    if (!skinned && !shaped) return still;
    rig.clips.push_back({"rest", 0.0f, {}});
  }
  const auto made = static_cast<uint32_t>(import_.scene.rigs.size());
  import_.scene.rigs.push_back(std::move(rig));
  if (shared) rig_of_skin_[node.skin] = made;
  return skinned ? RiggedNode{made, kNone, glm::dmat4(1.0)}
                 : RiggedNode{made, rig_node_.at(index), relative ? global : glm::dmat4(1.0)};
}

}  // namespace helio::scene
