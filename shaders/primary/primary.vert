#version 460
#extension GL_GOOGLE_include_directive : require
// Primary hits by rasterisation: positions are pulled by address and made relative to the camera before they are rotated,
// so that a world of kilometres loses no precision near the eye.
#define HELIO_OWN_PUSH
#include "lib/tables.glsl"
#include "shared/draw.h"

layout(buffer_reference, scalar) readonly buffer SlotTable { uint items[]; };
layout(push_constant, scalar) uniform Draw { DrawConstants draw; };

layout(location = 0) flat out uint out_slot;

void main() {
  const FrameConstants f = FrameRef(draw.frame).constants;
  const uint slot = SlotTable(draw.slots).items[gl_InstanceIndex];
  const InstanceRecord instance = InstanceTable(f.instances).items[slot];
  const vec3 p = PositionTable(draw.positions).items[IndexTable(draw.indices).items[gl_VertexIndex]];
  vec3 relative;
  for (int i = 0; i < 3; ++i) relative[i] = dot(instance.rows[i].xyz, p) + (instance.rows[i].w - f.position[i]);

  // Infinite reversed depth: near / distance. The jitter moves the sample from the pixel's centre.
  const vec2 offset = 2.0 * (vec2(0.5) - draw.jitter) / vec2(f.width, f.height);
  const float depth = dot(relative, f.forward);
  gl_Position = vec4(dot(relative, f.right) / (f.tangent * f.aspect) + offset.x * depth,
                     -dot(relative, f.up) / f.tangent + offset.y * depth, f.near_plane, depth);
  out_slot = slot;
}
