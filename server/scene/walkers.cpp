// Walkers: skinned figures on skeletons of thirteen joints, with a gait each. Metres; they face +z, left is +x.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "scene/catalogue.h"
#include "scene/mesh_builder.h"

namespace helio::scene {
namespace {

using glm::vec2, glm::vec3;

constexpr float kTurn = 2.0f * std::numbers::pi_v<float>;

enum JointName : uint16_t {
  kPelvis,
  kSpine,
  kHead,
  kArmL,
  kArmR,
  kForearmL,
  kForearmR,
  kThighL,
  kThighR,
  kShinL,
  kShinR,
  kFootL,
  kFootR,
  kJoints
};

/// Heights and half widths of a body of 1.75 m, and where its joints are.
constexpr float kAnkle = 0.08f, kKnee = 0.48f, kHip = 0.90f, kWaist = 1.04f, kElbow = 1.14f, kShoulder = 1.42f,
                kNeck = 1.50f;
constexpr float kHipX = 0.095f, kShoulderX = 0.19f;
constexpr float kThigh = kHip - kKnee, kShin = kKnee - kAnkle;
constexpr std::array<uint32_t, kJoints> kParent{kNone,   kPelvis, kSpine,  kSpine,  kSpine, kArmL, kArmR,
                                                kPelvis, kPelvis, kThighL, kThighR, kShinL, kShinR};
const std::array<vec3, kJoints> kJointAt{vec3(0, kHip + 0.02f, 0),
                                         vec3(0, kWaist, 0),
                                         vec3(0, kNeck, 0),
                                         vec3(kShoulderX, kShoulder, 0),
                                         vec3(-kShoulderX, kShoulder, 0),
                                         vec3(kShoulderX + 0.015f, kElbow, 0),
                                         vec3(-kShoulderX - 0.015f, kElbow, 0),
                                         vec3(kHipX, kHip, 0),
                                         vec3(-kHipX, kHip, 0),
                                         vec3(kHipX, kKnee, 0),
                                         vec3(-kHipX, kKnee, 0),
                                         vec3(kHipX, kAnkle, 0),
                                         vec3(-kHipX, kAnkle, 0)};

struct Look {
  const char* name;
  float height;  ///< metres
  float girth;   ///< of trunk and limbs, 1: slim
  size_t top, bottom, skin, hair;
  bool skirt, hat, long_hair;
  float stride;     ///< metres a cycle of two steps, for a body of 1.75 m
  float speed;      ///< metres a second
  float arm_swing;  ///< radians
};

constexpr std::array<Look, 10> kLooks{{
    {"walker_merchant", 1.78f, 1.25f, 0, 5, 0, 0, false, true, false, 1.22f, 1.15f, 0.35f},
    {"walker_maid", 1.64f, 0.95f, 1, 6, 1, 1, true, false, true, 1.10f, 1.20f, 0.28f},
    {"walker_smith", 1.84f, 1.20f, 2, 7, 2, 2, false, false, false, 1.34f, 1.40f, 0.42f},
    {"walker_baker", 1.70f, 1.35f, 3, 3, 0, 3, false, true, false, 1.12f, 1.05f, 0.30f},
    {"walker_student", 1.74f, 0.90f, 4, 8, 3, 0, false, false, false, 1.36f, 1.55f, 0.50f},
    {"walker_lady", 1.68f, 0.95f, 8, 0, 1, 3, true, true, true, 1.02f, 0.95f, 0.20f},
    {"walker_gardener", 1.72f, 1.10f, 9, 2, 2, 1, false, true, false, 1.20f, 1.20f, 0.33f},
    {"walker_child", 1.28f, 0.95f, 6, 4, 0, 2, false, false, false, 1.30f, 1.15f, 0.55f},
    {"walker_girl", 1.34f, 0.90f, 7, 1, 3, 0, true, false, true, 1.24f, 1.10f, 0.45f},
    {"walker_elder", 1.66f, 1.10f, 5, 9, 1, 3, false, true, false, 0.92f, 0.75f, 0.18f},
}};

float ease(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

VertexSkin between(uint16_t a, uint16_t b, float share_of_b) {
  return {{a, b, 0, 0}, {1.0f - share_of_b, share_of_b, 0.0f, 0.0f}};
}
VertexSkin legSkin(const vec3& p) {
  const bool left = p.x > 0.0f;
  if (p.y > kKnee)
    return between(left ? kThighL : kThighR, left ? kShinL : kShinR, 1.0f - ease(kKnee - 0.07f, kKnee + 0.07f, p.y));
  if (p.y > 0.16f)
    return between(left ? kShinL : kShinR, left ? kThighL : kThighR, ease(kKnee - 0.07f, kKnee + 0.07f, p.y));
  return between(left ? kFootL : kFootR, left ? kShinL : kShinR, ease(0.09f, 0.16f, p.y));
}
VertexSkin armSkin(const vec3& p) {
  const bool left = p.x > 0.0f;
  if (p.y > kShoulder - 0.02f) return between(left ? kArmL : kArmR, kSpine, 0.4f);
  return between(left ? kForearmL : kForearmR, left ? kArmL : kArmR, ease(kElbow - 0.06f, kElbow + 0.06f, p.y));
}
VertexSkin trunkSkin(const vec3& p) {
  if (p.y > kShoulder + 0.03f) return between(kSpine, kHead, ease(kShoulder + 0.03f, kNeck + 0.02f, p.y));
  return between(kPelvis, kSpine, ease(kHip + 0.04f, kWaist + 0.08f, p.y));
}
VertexSkin headSkin(const vec3&) { return between(kHead, kHead, 0.0f); }
/// A skirt hangs from the pelvis and is carried along by the leg on its side.
VertexSkin skirtSkin(const vec3& p) {
  const float carried = 0.55f * (1.0f - ease(0.45f, kHip, p.y)), left = ease(-0.12f, 0.12f, p.x);
  return {{kPelvis, kThighL, kThighR, 0}, {1.0f - carried, carried * left, carried * (1.0f - left), 0.0f}};
}

struct Ring {
  vec3 centre;
  vec2 radii;  ///< along x and z
};

class Figure {
 public:
  Figure(const Look& look, const Palette& palette) : look_(look), palette_(palette) { mesh_.name = look.name; }

  /// Rings one above the other, from the lowest up, closed at both ends.
  void tube(uint32_t material, const std::vector<Ring>& rings, uint32_t sides,
            const std::function<VertexSkin(const vec3&)>& skin) {
    std::vector<uint32_t>& indices = by_material_[material];
    const auto first = static_cast<uint32_t>(mesh_.positions.size());
    for (const Ring& ring : rings) {
      for (uint32_t s = 0; s < sides; ++s) {
        const float angle = kTurn * (static_cast<float>(s) + 0.5f) / static_cast<float>(sides);
        vertex(ring.centre + vec3(ring.radii.x * std::sin(angle), 0.0f, ring.radii.y * std::cos(angle)), skin);
      }
    }
    const auto at = [&](size_t ring, uint32_t side) {
      return first + static_cast<uint32_t>(ring) * sides + side % sides;
    };
    for (size_t r = 0; r + 1 < rings.size(); ++r) {
      for (uint32_t s = 0; s < sides; ++s) {
        const std::array<uint32_t, 6> quad{at(r, s), at(r, s + 1),     at(r + 1, s + 1),
                                           at(r, s), at(r + 1, s + 1), at(r + 1, s)};
        indices.insert(indices.end(), quad.begin(), quad.end());
      }
    }
    const uint32_t low = vertex(rings.front().centre, skin), high = vertex(rings.back().centre, skin);
    for (uint32_t s = 0; s < sides; ++s) {
      indices.insert(indices.end(), {low, at(0, s + 1), at(0, s)});
      indices.insert(indices.end(), {high, at(rings.size() - 1, s), at(rings.size() - 1, s + 1)});
    }
  }

  Mesh build() {
    const float girth = look_.girth;
    const uint32_t top = palette_.garment[look_.top], bottom = palette_.garment[look_.bottom],
                   skin = palette_.complexion[look_.skin], hair = palette_.hair[look_.hair];
    const auto wide = [girth](float x, float z) { return vec2(x * girth, z * girth); };
    tube(top,
         {{{0, 0.86f, 0}, wide(0.15f, 0.11f)},
          {{0, 0.98f, 0}, wide(0.165f, 0.12f)},
          {{0, 1.10f, 0}, wide(0.15f, 0.115f)},
          {{0, 1.28f, 0.01f}, wide(0.18f, 0.13f)},
          {{0, 1.40f, 0}, wide(0.175f, 0.10f)},
          {{0, 1.47f, 0}, {0.075f, 0.065f}}},
         8, trunkSkin);
    tube(skin, {{{0, 1.44f, 0.0f}, {0.05f, 0.055f}}, {{0, 1.52f, 0.01f}, {0.05f, 0.055f}}}, 6, trunkSkin);
    tube(skin,
         {{{0, 1.51f, 0.035f}, {0.035f, 0.045f}},
          {{0, 1.55f, 0.022f}, {0.062f, 0.078f}},
          {{0, 1.61f, 0.015f}, {0.076f, 0.095f}},
          {{0, 1.68f, 0.005f}, {0.075f, 0.092f}},
          {{0, 1.735f, 0.0f}, {0.045f, 0.058f}}},
         8, headSkin);
    tube(skin, {{{0, 1.595f, 0.108f}, {0.012f, 0.014f}}, {{0, 1.635f, 0.103f}, {0.007f, 0.006f}}}, 4,
         headSkin);  // nose
    const float nape = look_.long_hair ? 1.44f : 1.58f;
    tube(hair,
         {{{0, nape, -0.06f}, {0.055f, 0.04f}},
          {{0, 1.62f, -0.028f}, {0.086f, 0.082f}},
          {{0, 1.70f, -0.008f}, {0.085f, 0.098f}},
          {{0, 1.75f, -0.006f}, {0.05f, 0.06f}}},
         8, headSkin);
    if (look_.hat)
      tube(palette_.garment[(look_.top + 5) % palette_.garment.size()],
           {{{0, 1.70f, 0.0f}, {0.155f, 0.165f}},
            {{0, 1.715f, 0.0f}, {0.155f, 0.165f}},
            {{0, 1.72f, -0.002f}, {0.092f, 0.104f}},
            {{0, 1.82f, -0.004f}, {0.08f, 0.09f}}},
           8, headSkin);
    for (const float side : {1.0f, -1.0f}) {
      const float x = side * kHipX, a = side * kShoulderX;
      tube(look_.skirt ? palette_.complexion[look_.skin] : bottom,
           {{{x, 0.09f, 0}, wide(0.045f, 0.052f)},
            {{x, 0.30f, -0.012f}, wide(0.056f, 0.066f)},
            {{x, 0.41f, 0}, wide(0.055f, 0.06f)},
            {{x, 0.48f, 0.004f}, wide(0.06f, 0.066f)},
            {{x, 0.55f, 0}, wide(0.062f, 0.07f)},
            {{x, 0.72f, 0}, wide(0.078f, 0.088f)},
            {{x, 0.92f, 0}, wide(0.082f, 0.095f)}},
           6, legSkin);
      tube(palette_.leather,
           {{{x, 0.0f, 0.055f}, {0.045f, 0.125f}},
            {{x, 0.045f, 0.045f}, {0.046f, 0.115f}},
            {{x, 0.10f, -0.005f}, {0.044f, 0.056f}}},
           8, [](const vec3& p) { return between(p.x > 0.0f ? kFootL : kFootR, 0, 0.0f); });
      tube(top,
           {{{a + side * 0.03f, 0.90f, 0.015f}, {0.038f, 0.04f}},
            {{a + side * 0.018f, 1.08f, 0}, wide(0.042f, 0.045f)},
            {{a + side * 0.015f, kElbow, 0}, wide(0.044f, 0.047f)},
            {{a + side * 0.012f, 1.20f, 0}, wide(0.046f, 0.049f)},
            {{a, 1.34f, 0}, wide(0.055f, 0.058f)},
            {{a - side * 0.02f, 1.43f, 0}, wide(0.05f, 0.055f)}},
           6, armSkin);
      tube(skin,
           {{{a + side * 0.035f, 0.76f, 0.03f}, {0.018f, 0.03f}},
            {{a + side * 0.034f, 0.83f, 0.025f}, {0.022f, 0.042f}},
            {{a + side * 0.03f, 0.905f, 0.015f}, {0.025f, 0.028f}}},
           6, armSkin);
    }
    if (look_.skirt)
      tube(bottom,
           {{{0, 0.40f, 0}, wide(0.26f, 0.25f)},
            {{0, 0.60f, 0}, wide(0.225f, 0.21f)},
            {{0, 0.80f, 0}, wide(0.19f, 0.165f)},
            {{0, 0.95f, 0}, wide(0.172f, 0.13f)},
            {{0, 1.04f, 0}, wide(0.16f, 0.122f)}},
           10, skirtSkin);
    addSubmeshes(mesh_, by_material_);
    mesh_.uvs.resize(mesh_.positions.size());
    mesh_.finish();
    return std::move(mesh_);
  }

 private:
  float scale() const { return look_.height / 1.75f; }
  uint32_t vertex(const vec3& p, const std::function<VertexSkin(const vec3&)>& skin) {
    mesh_.positions.push_back(p * scale());
    mesh_.skin.push_back(skin(p));
    return static_cast<uint32_t>(mesh_.positions.size() - 1);
  }

  const Look& look_;
  const Palette& palette_;
  Mesh mesh_;
  std::map<uint32_t, std::vector<uint32_t>> by_material_;
};

/// Where an ankle is in a body that goes ahead, and how its foot is pitched (radians, toes down).
struct Step {
  float z, y, pitch;
};

/// A foot over a cycle that begins when it lands. On the ground it goes back at the speed of the body, so it stands
/// still in the world; the heel lifts about the toes; then it swings forward.
Step stepAt(float phase, float stride) {
  constexpr float kStance = 0.6f, kAhead = 0.24f, kHeelOff = 0.40f, kMostPitch = 0.75f, kLandingPitch = -0.16f;
  constexpr float kToe = 0.14f;  // from the ankle ahead, on the ground
  const auto onGround = [stride](float at) { return stride * (kAhead - at); };
  const auto pivoted = [](float z, float pitch) {
    return Step{z + kToe - kToe * std::cos(pitch) + kAnkle * std::sin(pitch),
                kAnkle * std::cos(pitch) + kToe * std::sin(pitch), pitch};
  };
  if (phase < 0.08f) return {onGround(phase), kAnkle, kLandingPitch * (1.0f - phase / 0.08f)};
  if (phase < kHeelOff) return {onGround(phase), kAnkle, 0.0f};
  if (phase < kStance) {
    const float t = (phase - kHeelOff) / (kStance - kHeelOff);
    return pivoted(onGround(phase), kMostPitch * t * t);
  }
  const Step off = pivoted(onGround(kStance), kMostPitch);
  const float t = (phase - kStance) / (1.0f - kStance), s = t * t * (3.0f - 2.0f * t);
  return {off.z + (onGround(0.0f) - off.z) * s,
          off.y + (kAnkle - off.y) * s + 0.05f * std::pow(std::sin(0.5f * kTurn * t), 2.0f),
          off.pitch + (kLandingPitch - off.pitch) * s};
}

/// Angles about x of thigh, shin and foot that bring the ankle to a step, from a hip at height `hip` [two-bone inverse
/// kinematics by the law of cosines].
std::array<float, 3> legAngles(const Step& step, float hip) {
  const float down = hip - step.y, reach = std::min(std::hypot(down, step.z), 0.9995f * (kThigh + kShin));
  const float towards = std::atan2(step.z, down);
  const float at_hip =
      std::acos(std::clamp((kThigh * kThigh + reach * reach - kShin * kShin) / (2.0f * kThigh * reach), -1.0f, 1.0f));
  const float at_knee =
      std::acos(std::clamp((kThigh * kThigh + kShin * kShin - reach * reach) / (2.0f * kThigh * kShin), -1.0f, 1.0f));
  const float thigh = -(towards + at_hip), shin = 0.5f * kTurn - at_knee;
  return {thigh, shin, step.pitch - thigh - shin};
}

glm::vec4 aboutX(float angle) { return {std::sin(0.5f * angle), 0.0f, 0.0f, std::cos(0.5f * angle)}; }
glm::vec4 aboutY(float angle) { return {0.0f, std::sin(0.5f * angle), 0.0f, std::cos(0.5f * angle)}; }

class ClipWriter {
 public:
  ClipWriter(std::string name, float duration) : clip_{std::move(name), duration, {}} {}
  template <typename Vector>
  void key(uint32_t node, ChannelTarget target, float time, const Vector& value) {
    Channel& channel = channels_[{node, static_cast<uint32_t>(target)}];
    channel.node = node;
    channel.target = target;
    channel.times.push_back(time);
    for (int c = 0; c < Vector::length(); ++c) channel.values.push_back(value[c]);
  }
  Clip take() {
    for (auto& [key, channel] : channels_) clip_.channels.push_back(std::move(channel));
    return std::move(clip_);
  }

 private:
  Clip clip_;
  std::map<std::pair<uint32_t, uint32_t>, Channel> channels_;
};

Clip gait(const Look& look) {
  constexpr int kKeys = 24;
  const float scale = look.height / 1.75f, duration = look.stride * scale / look.speed;
  // As high as legs reach where a foot lands, and a little more in between.
  const float longest = 0.993f * (kThigh + kShin), ahead = stepAt(0.0f, look.stride).z;
  const float low_hip = std::min(kHip - 0.02f, kAnkle + std::sqrt(longest * longest - ahead * ahead));
  const float bob = std::min(0.018f, 0.5f * (kAnkle + longest - low_hip));
  ClipWriter clip("walk", duration);
  for (int k = 0; k <= kKeys; ++k) {
    const float phase = static_cast<float>(k % kKeys) / kKeys, time = duration * static_cast<float>(k) / kKeys;
    const float lift = bob * (1.0f - std::cos(2.0f * kTurn * phase)), swing = std::cos(kTurn * phase);
    const float hip = low_hip + lift;
    clip.key(kPelvis, ChannelTarget::translation, time,
             vec3(0.012f * std::sin(kTurn * phase), hip + 0.02f, 0.0f) * scale);
    clip.key(kPelvis, ChannelTarget::rotation, time, aboutY(-0.06f * swing));
    clip.key(kSpine, ChannelTarget::rotation, time, aboutY(0.13f * swing));
    clip.key(kHead, ChannelTarget::rotation, time, aboutY(-0.07f * swing));
    clip.key(kArmL, ChannelTarget::rotation, time, aboutX(look.arm_swing * swing));
    clip.key(kArmR, ChannelTarget::rotation, time, aboutX(-look.arm_swing * swing));
    clip.key(kForearmL, ChannelTarget::rotation, time, aboutX(-0.18f - 0.5f * look.arm_swing * (1.0f - swing)));
    clip.key(kForearmR, ChannelTarget::rotation, time, aboutX(-0.18f - 0.5f * look.arm_swing * (1.0f + swing)));
    for (const bool left : {true, false}) {
      const float own = left ? phase : phase + (phase < 0.5f ? 0.5f : -0.5f);
      const auto [thigh, shin, foot] = legAngles(stepAt(own, look.stride), hip);
      clip.key(left ? kThighL : kThighR, ChannelTarget::rotation, time, aboutX(thigh));
      clip.key(left ? kShinL : kShinR, ChannelTarget::rotation, time, aboutX(shin));
      clip.key(left ? kFootL : kFootR, ChannelTarget::rotation, time, aboutX(foot));
    }
  }
  return clip.take();
}

/// Who has no way stands, breathes and looks around.
Clip idle(const Look& look) {
  constexpr int kKeys = 12;
  const float duration = 6.0f + 2.0f * look.arm_swing;
  ClipWriter clip("stand", duration);
  for (int k = 0; k <= kKeys; ++k) {
    const float phase = static_cast<float>(k % kKeys) / kKeys, time = duration * static_cast<float>(k) / kKeys;
    clip.key(kSpine, ChannelTarget::rotation, time, aboutX(0.02f * std::sin(2.0f * kTurn * phase)));
    clip.key(kHead, ChannelTarget::rotation, time,
             aboutY(0.45f * std::sin(kTurn * phase) * std::sin(0.5f * kTurn * phase)));
    clip.key(kArmL, ChannelTarget::rotation, time, aboutX(0.04f * std::sin(2.0f * kTurn * phase)));
    clip.key(kArmR, ChannelTarget::rotation, time, aboutX(0.04f * std::cos(2.0f * kTurn * phase)));
  }
  return clip.take();
}

Rig rigOf(const Look& look) {
  const float scale = look.height / 1.75f;
  Rig rig;
  rig.name = look.name;
  for (uint32_t j = 0; j < kJoints; ++j) {
    RigNode node;
    node.parent = kParent[j];
    node.translation = (kJointAt[j] - (node.parent == kNone ? vec3(0.0f) : kJointAt[node.parent])) * scale;
    node.rest[3] = node.translation;
    rig.nodes.push_back(node);
    Joint joint{j, glm::mat4x3(1.0f)};
    joint.inverse_bind[3] = -kJointAt[j] * scale;
    rig.joints.push_back(joint);
  }
  rig.clips = {idle(look), gait(look)};
  return rig;
}

}  // namespace

void addWalkers(Catalogue& catalogue) {
  for (const Look& look : kLooks) {
    const uint32_t prefab = catalogue.addRigged(Figure(look, catalogue.palette).build(), "walker", rigOf(look));
    catalogue.prefabs[prefab].travel_clip = 1;
    catalogue.prefabs[prefab].travel_speed = look.speed;
    catalogue.prefabs[prefab].out_of_step = true;
    catalogue.walkers.push_back(prefab);
  }
}

}  // namespace helio::scene
