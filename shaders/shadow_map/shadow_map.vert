#version 460
#extension GL_GOOGLE_include_directive : require
// A cascade of the sun's shadow map: parallel to the sun's direction, depth 1 towards the sun.
#include "primary/vertex.glsl"
#include "lib/shadow_map_table.glsl"

layout(location = 0) flat out uint out_material;
layout(location = 1) out vec3 out_mask;

void main() {
  const ShadowMap map = ShadowMapRef(draw.shadow_map).map;
  const ShadowCascade cascade = map.cascades[draw.cascade];
  const Vertex v = placeVertex(cascade.centre);
  gl_Position = vec4(dot(v.relative, map.right) / cascade.half_width, dot(v.relative, map.up) / cascade.half_width,
                     0.5 + 0.5 * dot(v.relative, map.to_sun) / map.half_depth, 1.0);
  out_material = v.material;
  out_mask = v.mask;
}
