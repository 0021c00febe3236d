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
  gl_Position = cameraClip(v.relative, draw.jitter);
  out_slot = v.slot | v.record.geometry << 24;
  out_level = v.record.level;
  out_material = v.material;
  out_mask = v.mask;
}
