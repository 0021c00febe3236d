// How an instance's vertices differ from its mesh's at rest: morph targets, then the skin, then the fit to the ground. The
// rasteriser's vertex shader, the pass that feeds BLASes and hits on what has no BLAS all call the one function below. Its
// arithmetic is `precise` in the first two, so they agree to the last bit: or there were cracks, and surfaces that shadow
// themselves.
#ifndef HELIO_DEFORM_GLSL
#define HELIO_DEFORM_GLSL
#include "lib/tables.glsl"
#include "shared/animation.h"

#ifndef HELIO_PRECISE
#define HELIO_PRECISE precise
#endif

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer DeformRef { DeformRecord record; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer MeshDeformRef { MeshDeform mesh; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer GroundRef { GroundRecord ground; };
layout(buffer_reference, scalar) readonly buffer SkinTable { VertexSkinRecord items[]; };
layout(buffer_reference, scalar) readonly buffer RowTable { vec4 rows[]; };
layout(buffer_reference, scalar) readonly buffer NumberTable { float items[]; };

// Linear blend skinning: the joints' rows mixed by the vertex's weights.
void blendJoints(MeshDeform mesh, uint64_t palette, uint vertex, out HELIO_PRECISE vec4 rows[3]) {
  const VertexSkinRecord skin = SkinTable(mesh.skin).items[vertex];
  const uint joints[4] = uint[4](skin.joints_low & 0xffffu, skin.joints_low >> 16, skin.joints_high & 0xffffu, skin.joints_high >> 16);
  const vec2 low = unpackUnorm2x16(skin.weights_low), high = unpackUnorm2x16(skin.weights_high);
  const float weights[4] = float[4](low.x, low.y, high.x, high.y);
  HELIO_PRECISE float sum = 0.0;
  for (int i = 0; i < 3; ++i) rows[i] = vec4(0.0);
  for (int k = 0; k < 4; ++k) {
    if (weights[k] == 0.0) continue;
    sum = sum + weights[k];
    for (int i = 0; i < 3; ++i) rows[i] = rows[i] + weights[k] * RowTable(palette).rows[3u * joints[k] + i];
  }
  for (int i = 0; i < 3; ++i) rows[i] = rows[i] / sum;
}

// Height of the ground: linear on the two triangles of each lattice square.
float groundHeight(GroundRecord g, vec2 xz) {
  const vec2 last = vec2(g.columns - 1u, g.rows - 1u);
  HELIO_PRECISE vec2 cell = clamp((xz - g.origin) / g.spacing, vec2(0.0), last);
  const vec2 low = min(floor(cell), max(last - 1.0, vec2(0.0)));
  HELIO_PRECISE vec2 f = cell - low;
  NumberTable heights = NumberTable(g.heights);
  const uint at = uint(low.y) * g.columns + uint(low.x);
  const float a = heights.items[at], b = heights.items[at + 1u], c = heights.items[at + g.columns], d = heights.items[at + g.columns + 1u];
  HELIO_PRECISE float h = f.x >= f.y ? a + f.x * (b - a) + f.y * (d - b) : a + f.y * (c - a) + f.x * (d - c);
  return h;
}

const float kFarthest = 1e8;      // metres
const float kSteepestDrop = 3.0;  // metres that a wall reaches down at most (scene/catalogue.cpp)

// A vertex in the space of its instance.
vec3 deformPosition(DeformRecord deform, InstanceRecord instance, vec3 rest, uint vertex) {
  const MeshDeform mesh = MeshDeformRef(deform.mesh).mesh;
  HELIO_PRECISE vec3 p = rest;
  for (uint t = 0u; t < mesh.morph_count; ++t) {
    const float weight = NumberTable(deform.weights).items[t];
    if (weight != 0.0) p = p + weight * PositionTable(mesh.morphs).items[2u * t * mesh.vertex_count + vertex];
  }
  if (mesh.skin != 0ul) {
    HELIO_PRECISE vec4 rows[3];
    blendJoints(mesh, deform.palette, vertex, rows);
    HELIO_PRECISE vec3 q;
    for (int i = 0; i < 3; ++i) q[i] = rows[i].x * p.x + rows[i].y * p.y + rows[i].z * p.z + rows[i].w;
    p = q;
  }
  if (mesh.fit_height > 0.0 && deform.ground != 0ul) {
    HELIO_PRECISE float x = instance.rows[0].x * p.x + instance.rows[0].y * p.y + instance.rows[0].z * p.z + instance.rows[0].w;
    HELIO_PRECISE float z = instance.rows[2].x * p.x + instance.rows[2].y * p.y + instance.rows[2].z * p.z + instance.rows[2].w;
    const float up = instance.rows[1].y;
    if (abs(up) > 1e-6) {
      HELIO_PRECISE float drop = clamp((groundHeight(GroundRef(deform.ground).ground, vec2(x, z)) - instance.rows[1].w) / up, -kSteepestDrop, 0.5 * mesh.fit_height);
      HELIO_PRECISE float share = 1.0 - clamp(p.y / mesh.fit_height, 0.0, 1.0);
      p.y = p.y + share * drop;
    }
  }
  // A rig may throw a vertex to where numbers end: then it is nowhere in particular, but it is a number.
  return all(lessThan(abs(p), vec3(kFarthest))) ? p : vec3(0.0);
}

// Its normal (by the cofactor matrix: right under any scale) and tangent; of no particular length.
void deformFrame(DeformRecord deform, uint vertex, inout vec3 normal, inout vec3 tangent) {
  const MeshDeform mesh = MeshDeformRef(deform.mesh).mesh;
  for (uint t = 0u; t < mesh.morph_count; ++t)
    normal += NumberTable(deform.weights).items[t] * PositionTable(mesh.morphs).items[(2u * t + 1u) * mesh.vertex_count + vertex];
  if (mesh.skin == 0ul) return;
  HELIO_PRECISE vec4 rows[3];
  blendJoints(mesh, deform.palette, vertex, rows);
  const vec3 a = rows[0].xyz, b = rows[1].xyz, c = rows[2].xyz;
  const vec3 turned = vec3(dot(cross(b, c), normal), dot(cross(c, a), normal), dot(cross(a, b), normal));
  const float size = max(max(abs(turned.x), abs(turned.y)), abs(turned.z));
  if (size > 0.0 && !isinf(size)) normal = (dot(a, cross(b, c)) < 0.0 ? -turned : turned) / size;
  tangent = vec3(dot(a, tangent), dot(b, tangent), dot(c, tangent));
}

#endif
