#version 460
#extension GL_GOOGLE_include_directive : require
#include "primary/draw.glsl"

layout(location = 0) flat in uint slot;  // and the geometry
layout(location = 1) flat in uint level;
layout(location = 2) flat in uint material;
layout(location = 3) in vec3 mask;
layout(location = 0) out uvec2 visibility;

void main() {
  if (kAlphaMasks && isCutOut(MaterialTable(frame.materials).items[material], mask.xy, mask.z)) discard;
  visibility = uvec2(slot, uint(gl_PrimitiveID) | level << kVisibilityLevelShift);
}
