#include "scene/animation.h"

#include <algorithm>
#include <cmath>

#include "scene/scene.h"

namespace helio::scene {
namespace {

constexpr float kCornerReach = 0.6f;  // metres before and behind: how wide corners are rounded

/// Which two keys a time lies between, and how far.
struct Span {
  size_t from = 0, to = 0;
  float t = 0.0f;        ///< [0, 1)
  float seconds = 0.0f;  ///< from one to the other
};

Span spanAt(const std::vector<float>& times, float time) {
  const auto after = static_cast<size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
  if (after == 0) return {};
  if (after == times.size()) return {after - 1, after - 1, 0.0f, 0.0f};
  const float seconds = times[after] - times[after - 1];
  return {after - 1, after, (time - times[after - 1]) / seconds, seconds};
}

/// Shortest way on the sphere of unit quaternions [Shoemake 1985]; nearly equal ones are mixed.
glm::vec4 slerp(const glm::vec4& a, glm::vec4 b, float t) {
  float cosine = glm::dot(a, b);
  if (cosine < 0.0f) {
    b = -b;
    cosine = -cosine;
  }
  if (cosine > 0.9995f) return a + (b - a) * t;
  const float angle = std::acos(cosine), sine = std::sin(angle);
  return (a * std::sin((1.0f - t) * angle) + b * std::sin(t * angle)) / sine;
}

/// A channel's value, component by component from `first` on.
template <typename Vector>
Vector sample(const Channel& channel, float time, size_t first, size_t stride) {
  const auto read = [&](size_t key, size_t part) {
    const size_t parts = channel.interpolation == Interpolation::cubic_spline ? 3 : 1;
    Vector v{};
    for (int c = 0; c < Vector::length(); ++c)
      v[c] = channel.values[(key * parts + part) * stride + first + static_cast<size_t>(c)];
    return v;
  };
  const Span span = spanAt(channel.times, time);
  if (channel.interpolation == Interpolation::cubic_spline) {
    // Hermite splines, tangents scaled by the time between the keys [glTF 2.0, appendix C.5].
    const float t = span.t, t2 = t * t, t3 = t2 * t;
    return read(span.from, 1) * (2.0f * t3 - 3.0f * t2 + 1.0f) +
           read(span.from, 2) * (span.seconds * (t3 - 2.0f * t2 + t)) + read(span.to, 1) * (3.0f * t2 - 2.0f * t3) +
           read(span.to, 0) * (span.seconds * (t3 - t2));
  }
  const Vector from = read(span.from, 0);
  if (channel.interpolation == Interpolation::step || span.to == span.from) return from;
  const Vector to = read(span.to, 0);
  if constexpr (Vector::length() == 4) return slerp(from, to, span.t);
  else return from + (to - from) * span.t;
}

glm::mat4x3 compose(const glm::vec3& translation, const glm::vec4& q, const glm::vec3& scale) {
  const float length = glm::length(q);
  const glm::quat rotation = length > 1e-12f ? glm::quat(q.w / length, q.x / length, q.y / length, q.z / length)
                                             : glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
  const glm::mat3 axes = glm::mat3_cast(rotation);
  return {axes[0] * scale.x, axes[1] * scale.y, axes[2] * scale.z, translation};
}

}  // namespace

glm::mat4x3 concatenate(const glm::mat4x3& a, const glm::mat4x3& b) {
  const glm::mat3 axes(a);
  return {axes * b[0], axes * b[1], axes * b[2], axes * b[3] + a[3]};
}

double clipTime(double time, float duration) {
  if (!(duration > 0.0f)) return 0.0;
  const double period = static_cast<double>(duration), within = std::fmod(time, period);
  return within < 0.0 ? within + period : within;
}

std::vector<glm::mat4x3> nodesAt(const Rig& rig, const Clip& clip, float time) {
  struct Moved {
    glm::vec3 translation;
    glm::vec4 rotation;
    glm::vec3 scale;
    bool any = false;
  };
  std::vector<Moved> moved;
  for (const RigNode& node : rig.nodes) {
    const glm::quat& q = node.rotation;
    moved.push_back({node.translation, {q.x, q.y, q.z, q.w}, node.scale});
  }
  for (const Channel& channel : clip.channels) {
    if (channel.target == ChannelTarget::weights) continue;
    Moved& node = moved[channel.node];
    node.any = true;
    if (channel.target == ChannelTarget::translation) node.translation = sample<glm::vec3>(channel, time, 0, 3);
    if (channel.target == ChannelTarget::rotation) node.rotation = sample<glm::vec4>(channel, time, 0, 4);
    if (channel.target == ChannelTarget::scale) node.scale = sample<glm::vec3>(channel, time, 0, 3);
  }
  std::vector<glm::mat4x3> nodes(rig.nodes.size());
  for (size_t i = 0; i < nodes.size(); ++i) {
    const Moved& m = moved[i];
    const glm::mat4x3 local = m.any ? compose(m.translation, m.rotation, m.scale) : rig.nodes[i].rest;
    nodes[i] = rig.nodes[i].parent == kNone ? local : concatenate(nodes[rig.nodes[i].parent], local);
  }
  return nodes;
}

std::vector<glm::mat4x3> jointsAt(const Rig& rig, const Clip& clip, float time) {
  const std::vector<glm::mat4x3> nodes = nodesAt(rig, clip, time);
  std::vector<glm::mat4x3> joints;
  for (const Joint& joint : rig.joints) joints.push_back(concatenate(nodes[joint.node], joint.inverse_bind));
  return joints;
}

std::vector<float> weightsAt(const Rig& rig, const Clip& clip, float time) {
  std::vector<float> weights = rig.weights;
  for (const Channel& channel : clip.channels) {
    if (channel.target != ChannelTarget::weights) continue;
    for (size_t k = 0; k < weights.size(); ++k) weights[k] = sample<glm::vec1>(channel, time, k, weights.size()).x;
  }
  return weights;
}

Route::Route(std::vector<glm::vec3> way) : points(std::move(way)) {
  if (points.empty()) return;
  double along = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    lengths.push_back(static_cast<float>(along));
    along += static_cast<double>(glm::distance(points[i], points[(i + 1) % points.size()]));
  }
  lengths.push_back(static_cast<float>(along));
}

glm::vec3 Route::point(double distance) const {
  const auto along = static_cast<float>(clipTime(distance, length()));
  const auto after = static_cast<size_t>(std::upper_bound(lengths.begin(), lengths.end(), along) - lengths.begin());
  const size_t i = std::clamp<size_t>(after, 1, points.size()) - 1;
  const float stretch = lengths[i + 1] - lengths[i];
  const float t = stretch > 0.0f ? std::min(1.0f, (along - lengths[i]) / stretch) : 0.0f;
  return glm::mix(points[i], points[(i + 1) % points.size()], t);
}

glm::mat4x3 Route::at(double distance) const {
  if (points.empty()) return glm::mat4x3(1.0f);
  const glm::vec3 behind = point(distance - static_cast<double>(kCornerReach)),
                  ahead = point(distance + static_cast<double>(kCornerReach)), here = point(distance);
  glm::vec3 z(ahead.x - behind.x, 0.0f, ahead.z - behind.z);
  const float length = glm::length(z);
  z = length > 1e-6f ? z / length : glm::vec3(0.0f, 0.0f, 1.0f);
  // The mean of three points of the way rounds its corners and stays on it where it is straight.
  return {{z.z, 0.0f, -z.x}, {0.0f, 1.0f, 0.0f}, z, (behind + here + ahead) / 3.0f};
}

float HeightGrid::height(const glm::vec2& xz) const {
  const size_t rows = heights.size() / columns;
  const glm::vec2 last(static_cast<float>(columns) - 1.0f, static_cast<float>(rows) - 1.0f);
  const glm::vec2 cell = glm::clamp((xz - origin) / spacing, glm::vec2(0.0f), last);
  const glm::vec2 low = glm::min(glm::floor(cell), glm::max(last - 1.0f, glm::vec2(0.0f))), f = cell - low;
  const auto at = [&](float x, float z) {
    return heights[static_cast<size_t>(std::min(z, last.y)) * columns + static_cast<size_t>(std::min(x, last.x))];
  };
  const float a = at(low.x, low.y), d = at(low.x + 1.0f, low.y + 1.0f);
  return f.x >= f.y ? a + (at(low.x + 1.0f, low.y) - a) * f.x + (d - at(low.x + 1.0f, low.y)) * f.y
                    : a + (at(low.x, low.y + 1.0f) - a) * f.y + (d - at(low.x, low.y + 1.0f)) * f.x;
}

}  // namespace helio::scene
