// Places a vertex of the draw: positions are pulled by address, deformed by the function that feeds BLASes too, and made
// relative to the eye before they are rotated, so that a world of kilometres loses no precision near it.
#ifndef HELIO_PRIMARY_VERTEX_GLSL
#define HELIO_PRIMARY_VERTEX_GLSL
#include "primary/draw.glsl"
#include "lib/deform.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer WordTable { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DrawTable { DrawRecord items[]; };

struct Vertex {
  vec3 relative;  // to the eye, world axes
  uint slot;
  DrawRecord record;
  uint material;
  vec3 mask;      // where the alpha mask is read, and the vertex' alpha
};

Vertex placeVertex(vec3 eye) {
  Vertex v;
  v.record = DrawTable(draw.draws).items[WordTable(draw.records).items[gl_DrawID]];
  v.slot = WordTable(draw.slots).items[gl_InstanceIndex];
  const InstanceRecord instance = InstanceTable(frame.instances).items[v.slot];
  const uint vertex = gl_VertexIndex;
  vec3 p = PositionTable(v.record.positions).items[vertex];
  if (kDeforming && instance.deform != 0ul) p = deformPosition(DeformRef(instance.deform).record, instance, p, vertex);
  for (int i = 0; i < 3; ++i) v.relative[i] = dot(instance.rows[i].xyz, p) + (instance.rows[i].w - eye[i]);
  v.material = 0u;
  v.mask = vec3(0.0);
  if (kAlphaMasks) {  // what has a mask has the same vertices at every level
    const GeometryRecord geometry = GeometryTable(frame.geometries).items[MeshTable(frame.meshes).items[instance.mesh].first_geometry + v.record.geometry];
    v.material = geometry.material;
    v.mask = vec3(baseColorUv(geometry, MaterialTable(frame.materials).items[geometry.material], vertex), vertexAlpha(geometry, vertex));
  }
  return v;
}

#endif
