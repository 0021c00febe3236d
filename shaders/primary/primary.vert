#version 460
#extension GL_GOOGLE_include_directive : require
// Primary hits by rasterisation.
#include "primary/vertex.glsl"

layout(location = 0) flat out uint out_slot;  // and the geometry
layout(location = 1) flat out uint out_level;
layout(location = 2) flat out uint out_material;
layout(location = 3) out vec3 out_mask;

void main() {
  const Vertex v = placeVertex(frame.position);
  // Infinite reversed depth: near / distance. The jitter moves the sample from the pixel's centre.
  const vec2 offset = 2.0 * (vec2(0.5) - draw.jitter) / vec2(frame.width, frame.height);
  const float depth = dot(v.relative, frame.forward);
  gl_Position = vec4(dot(v.relative, frame.right) / (frame.tangent * frame.aspect) + offset.x * depth,
                     -dot(v.relative, frame.up) / frame.tangent + offset.y * depth, frame.near_plane, depth);
  out_slot = v.slot | v.record.geometry << 24;
  out_level = v.record.level;
  out_material = v.material;
  out_mask = v.mask;
}
