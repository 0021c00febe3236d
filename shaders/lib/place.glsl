// Where the rasteriser draws a vertex: deformed by the function that feeds BLASes too, and made relative to a point before it is rotated,
// so that a world of kilometres loses no precision near it.
#ifndef HELIO_PLACE_GLSL
#define HELIO_PLACE_GLSL
#include "lib/deform.glsl"
#include "lib/shadow_map_table.glsl"
#include "shared/draw.h"

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer WordTable { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DrawTable { DrawRecord items[]; };

vec3 placeVertex(DrawRecord record, InstanceRecord instance, uint vertex, vec3 origin) {
  vec3 p = PositionTable(record.positions).items[vertex], relative;
  if (kDeforming && instance.deform != 0ul) p = deformPosition(DeformRef(instance.deform).record, instance, p, vertex);
  for (int i = 0; i < 3; ++i) relative[i] = dot(instance.rows[i].xyz, p) + (instance.rows[i].w - origin[i]);
  return relative;
}

// What has a mask has the same vertices at every level.
uint geometryOf(DrawRecord record, InstanceRecord instance) { return MeshTable(frame.meshes).items[instance.mesh].first_geometry + record.geometry; }

// Of the camera; `relative` to it. Infinite reversed depth: near / distance. The jitter moves the sample from the pixel's centre.
vec4 cameraClip(vec3 relative, vec2 jitter) {
  const vec2 offset = 2.0 * (vec2(0.5) - jitter) / vec2(frame.width, frame.height);
  const float depth = dot(relative, frame.forward);
  return vec4(dot(relative, frame.right) / (frame.tangent * frame.aspect) + offset.x * depth,
              -dot(relative, frame.up) / frame.tangent + offset.y * depth, frame.near_plane, depth);
}

// Of a cascade of the sun's shadow map; `relative` to its centre. Parallel to the sun's direction, depth 1 towards the sun.
vec4 shadowClip(ShadowMap map, ShadowCascade cascade, vec3 relative) {
  return vec4(dot(relative, map.right) / cascade.half_width, dot(relative, map.up) / cascade.half_width,
              0.5 + 0.5 * dot(relative, map.to_sun) / map.half_depth, 1.0);
}

#endif
