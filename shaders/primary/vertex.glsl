// A vertex of the draw.
#ifndef HELIO_PRIMARY_VERTEX_GLSL
#define HELIO_PRIMARY_VERTEX_GLSL
#include "primary/draw.glsl"
#include "lib/place.glsl"

struct Vertex {
  vec3 relative;  // to the origin, world axes
  uint slot;
  DrawRecord record;
  uint material;
  vec3 mask;      // where the alpha mask is read, and the vertex' alpha
};

Vertex placeVertex(vec3 origin) {
  Vertex v;
  v.record = DrawTable(draw.draws).items[WordTable(draw.records).items[gl_DrawID]];
  v.slot = WordTable(draw.slots).items[gl_InstanceIndex];
  const InstanceRecord instance = InstanceTable(frame.instances).items[v.slot];
  const uint vertex = gl_VertexIndex;
  v.relative = placeVertex(v.record, instance, vertex, origin);
  v.material = 0u;
  v.mask = vec3(0.0);
  if (kAlphaMasks) {
    const GeometryRecord geometry = GeometryTable(frame.geometries).items[geometryOf(v.record, instance)];
    v.material = geometry.material;
    v.mask = vec3(baseColorUv(geometry, MaterialTable(frame.materials).items[geometry.material], vertex), vertexAlpha(geometry, vertex));
  }
  return v;
}

#endif
