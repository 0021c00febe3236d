#version 460
#extension GL_GOOGLE_include_directive : require
#include "primary/draw.glsl"

layout(location = 0) flat in uint material;
layout(location = 1) in vec3 mask;

void main() {
  if (kAlphaMasks && isCutOut(MaterialTable(frame.materials).items[material], mask.xy, mask.z)) discard;
}
