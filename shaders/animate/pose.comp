#version 460
#extension GL_GOOGLE_include_directive : require
// Poses: one thread a unit samples its clip at its time, takes the nodes to the rig's space, and writes the joints' matrices
// and the morph weights [glTF 2.0, §3.11 and appendix C].
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/animation.h"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer PoseTable { PoseRecord items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer ClipRef { ClipRecord clip; };
layout(buffer_reference, scalar) readonly buffer NodeTable { ClipNode items[]; };
layout(buffer_reference, scalar) readonly buffer ChannelTable { ChannelRecord items[]; };
layout(buffer_reference, scalar) readonly buffer JointTable { JointRecord items[]; };
layout(buffer_reference, scalar) readonly buffer NumberTable { float items[]; };
layout(buffer_reference, scalar) buffer RowTable { vec4 rows[]; };
layout(buffer_reference, scalar) buffer WeightTable { float items[]; };
layout(push_constant, scalar) uniform Pose { PoseConstants constants; };

struct Span {
  uint from;
  uint to;
  float t;
  float seconds;
};

// The keys on both sides of a time; before the first and behind the last, that one.
Span spanAt(NumberTable numbers, ChannelRecord channel, float time) {
  uint low = 0u, high = channel.key_count;  // the first key later than `time` is in [low, high]
  while (low < high) {
    const uint middle = (low + high) / 2u;
    if (numbers.items[channel.first_time + middle] > time) high = middle;
    else low = middle + 1u;
  }
  if (low == 0u) return Span(0u, 0u, 0.0, 0.0);
  if (low == channel.key_count) return Span(low - 1u, low - 1u, 0.0, 0.0);
  const float before = numbers.items[channel.first_time + low - 1u];
  const float seconds = numbers.items[channel.first_time + low] - before;
  return Span(low - 1u, low, (time - before) / seconds, seconds);
}

vec4 readKey(NumberTable numbers, ChannelRecord channel, uint key, uint part, uint first, uint components, uint stride) {
  const uint parts = channel.interpolation == kInterpolateCubic ? 3u : 1u;
  const uint at = channel.first_value + (key * parts + part) * stride + first;
  vec4 v = vec4(0.0);
  for (uint c = 0u; c < components; ++c) v[c] = numbers.items[at + c];
  return v;
}

vec4 slerp(vec4 a, vec4 b, float t) {
  float cosine = dot(a, b);
  if (cosine < 0.0) {
    b = -b;
    cosine = -cosine;
  }
  if (cosine > 0.9995) return a + (b - a) * t;
  const float angle = acos(cosine);
  return (a * sin((1.0 - t) * angle) + b * sin(t * angle)) / sin(angle);
}

vec4 sampleChannel(NumberTable numbers, ChannelRecord channel, float time, uint first, uint components, uint stride) {
  const Span span = spanAt(numbers, channel, time);
  if (channel.interpolation == kInterpolateCubic) {
    const float t = span.t, t2 = t * t, t3 = t2 * t;
    return readKey(numbers, channel, span.from, 1u, first, components, stride) * (2.0 * t3 - 3.0 * t2 + 1.0) +
           readKey(numbers, channel, span.from, 2u, first, components, stride) * (span.seconds * (t3 - 2.0 * t2 + t)) +
           readKey(numbers, channel, span.to, 1u, first, components, stride) * (3.0 * t2 - 2.0 * t3) +
           readKey(numbers, channel, span.to, 0u, first, components, stride) * (span.seconds * (t3 - t2));
  }
  const vec4 a = readKey(numbers, channel, span.from, 0u, first, components, stride);
  if (channel.interpolation == kInterpolateStep || span.to == span.from) return a;
  const vec4 b = readKey(numbers, channel, span.to, 0u, first, components, stride);
  return channel.target == kTargetRotation ? slerp(a, b, span.t) : a + (b - a) * span.t;
}

// Rows of translation * rotation * scale.
void compose(vec3 translation, vec4 q, vec3 scale, out vec4 rows[3]) {
  const float size = length(q);
  q = size > 1e-12 ? q / size : vec4(0.0, 0.0, 0.0, 1.0);
  const vec3 x = vec3(1.0 - 2.0 * (q.y * q.y + q.z * q.z), 2.0 * (q.x * q.y + q.w * q.z), 2.0 * (q.x * q.z - q.w * q.y)) * scale.x;
  const vec3 y = vec3(2.0 * (q.x * q.y - q.w * q.z), 1.0 - 2.0 * (q.x * q.x + q.z * q.z), 2.0 * (q.y * q.z + q.w * q.x)) * scale.y;
  const vec3 z = vec3(2.0 * (q.x * q.z + q.w * q.y), 2.0 * (q.y * q.z - q.w * q.x), 1.0 - 2.0 * (q.x * q.x + q.y * q.y)) * scale.z;
  for (int i = 0; i < 3; ++i) rows[i] = vec4(x[i], y[i], z[i], translation[i]);
}

// a * b of affine maps.
void concatenate(vec4 a[3], vec4 b[3], out vec4 rows[3]) {
  for (int i = 0; i < 3; ++i) rows[i] = a[i].x * b[0] + a[i].y * b[1] + a[i].z * b[2] + vec4(0.0, 0.0, 0.0, a[i].w);
}

void main() {
  if (gl_GlobalInvocationID.x >= constants.count) return;
  const PoseRecord pose = PoseTable(constants.poses).items[gl_GlobalInvocationID.x];
  const ClipRecord clip = ClipRef(pose.clip).clip;
  NumberTable numbers = NumberTable(clip.numbers);
  RowTable nodes = RowTable(pose.nodes), palette = RowTable(pose.palette), previous_palette = RowTable(pose.previous_palette);
  const bool keeps = pose.previous_palette != 0ul;

  for (uint n = 0u; n < clip.node_count; ++n) {
    const ClipNode node = NodeTable(clip.nodes).items[n];
    vec4 local[3] = node.rest;
    if (node.channel_count > 0u) {
      vec3 translation = node.translation, scale = node.scale;
      vec4 rotation = node.rotation;
      for (uint c = 0u; c < node.channel_count; ++c) {
        const ChannelRecord channel = ChannelTable(clip.channels).items[node.first_channel + c];
        const uint components = channel.target == kTargetRotation ? 4u : 3u;
        const vec4 value = sampleChannel(numbers, channel, pose.time, 0u, components, components);
        if (channel.target == kTargetTranslation) translation = value.xyz;
        else if (channel.target == kTargetRotation) rotation = value;
        else scale = value.xyz;
      }
      compose(translation, rotation, scale, local);
    }
    vec4 global[3] = local;
    if (node.parent != kNoNode) {
      vec4 parent[3];
      for (int i = 0; i < 3; ++i) parent[i] = nodes.rows[3u * node.parent + i];
      concatenate(parent, local, global);
    }
    for (int i = 0; i < 3; ++i) nodes.rows[3u * n + i] = global[i];
  }
  for (uint j = 0u; j < clip.joint_count; ++j) {
    const JointRecord joint = JointTable(clip.joints).items[j];
    vec4 node[3], rows[3];
    for (int i = 0; i < 3; ++i) node[i] = nodes.rows[3u * joint.node + i];
    concatenate(node, joint.inverse_bind, rows);
    for (int i = 0; i < 3; ++i) {
      if (keeps) previous_palette.rows[3u * j + i] = pose.first != 0u ? rows[i] : palette.rows[3u * j + i];
      palette.rows[3u * j + i] = rows[i];
    }
  }
  for (uint k = 0u; k < clip.weight_count; ++k) {
    float weight = numbers.items[clip.rest_weights + k];
    if (clip.weight_channel != kNoNode)
      weight = sampleChannel(numbers, ChannelTable(clip.channels).items[clip.weight_channel], pose.time, k, 1u, clip.weight_count).x;
    WeightTable weights = WeightTable(pose.weights);
    if (keeps) WeightTable(pose.previous_weights).items[k] = pose.first != 0u ? weight : weights.items[k];
    weights.items[k] = weight;
  }
}
