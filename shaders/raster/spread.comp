#version 460
#extension GL_GOOGLE_include_directive : require
// Rasterising, second: a group lists the parts of a triangle that has many. One thread takes a millisecond for a wall beside the camera, and
// all else is done by then.
#include "raster/parts.glsl"

layout(local_size_x = kSpreadGroup) in;

void main() {
  const uint count = min(rasterCounts().counts.spread[raster.cascade], spreadCapacity());
  for (uint i = gl_WorkGroupID.x; i < count; i += gl_NumWorkGroups.x) {
    const uint id = spreadTriangles().items[i];
    const Drawn d = drawnTriangle(id);
    const InstanceRecord instance = InstanceTable(frame.instances).items[d.slot];
    const vec4 clip[3] = vec4[](clipCorner(d, instance, 0u), clipCorner(d, instance, 1u), clipCorner(d, instance, 2u));
    listParts(shapeOf(clip), gl_LocalInvocationIndex, kSpreadGroup, id, d, instance);
  }
}
