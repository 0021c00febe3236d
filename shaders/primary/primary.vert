#version 460
#extension GL_GOOGLE_include_directive : require
// Primary hits by rasterisation: positions are pulled by address and made relative to the camera before they are rotated,
// so that a world of kilometres loses no precision near the eye.
#include "primary/draw.glsl"
#include "lib/deform.glsl"

layout(buffer_reference, scalar) readonly buffer SlotTable { uint items[]; };

layout(location = 0) flat out uint out_slot;
layout(location = 1) flat out uint out_material;
layout(location = 2) out vec3 out_mask;  // where the alpha mask is read, and the vertex' alpha

void main() {
  const uint slot = SlotTable(draw.slots).items[gl_InstanceIndex];
  const InstanceRecord instance = InstanceTable(frame.instances).items[slot];
  const uint vertex = IndexTable(draw.indices).items[gl_VertexIndex];
  vec3 p = PositionTable(draw.positions).items[vertex];
  if (kDeforming && instance.deform != 0ul) p = deformPosition(DeformRef(instance.deform).record, instance, p, vertex);
  vec3 relative;
  for (int i = 0; i < 3; ++i) relative[i] = dot(instance.rows[i].xyz, p) + (instance.rows[i].w - frame.position[i]);

  // Infinite reversed depth: near / distance. The jitter moves the sample from the pixel's centre.
  const vec2 offset = 2.0 * (vec2(0.5) - draw.jitter) / vec2(frame.width, frame.height);
  const float depth = dot(relative, frame.forward);
  gl_Position = vec4(dot(relative, frame.right) / (frame.tangent * frame.aspect) + offset.x * depth,
                     -dot(relative, frame.up) / frame.tangent + offset.y * depth, frame.near_plane, depth);
  out_slot = slot;
  out_material = 0u;
  out_mask = vec3(0.0);
  if (kAlphaMasks) {
    const GeometryRecord geometry = GeometryTable(frame.geometries).items[MeshTable(frame.meshes).items[instance.mesh].first_geometry + draw.geometry];
    out_material = geometry.material;
    out_mask = vec3(baseColorUv(geometry, MaterialTable(frame.materials).items[geometry.material], vertex), vertexAlpha(geometry, vertex));
  }
}
