#version 460
#extension GL_GOOGLE_include_directive : require
// Deformed vertices of what enters a BLAS: a row of groups a unit.
#define HELIO_OWN_PUSH
#include "lib/deform.glsl"

layout(local_size_x = 64) in;

layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer JobTable { DeformJob items[]; };
layout(buffer_reference, scalar) writeonly buffer DeformedTable { vec3 items[]; };
layout(push_constant, scalar) uniform Deform { DeformConstants constants; };

void main() {
  const DeformJob job = JobTable(constants.jobs).items[gl_WorkGroupID.y];
  const uint vertex = gl_GlobalInvocationID.x;
  if (vertex >= job.vertex_count) return;
  const InstanceRecord instance = InstanceTable(constants.instances).items[job.slot];
  const DeformRecord deform = DeformRef(instance.deform).record;
  DeformedTable(job.output_).items[vertex] = deformPosition(deform, instance, PositionTable(job.rest).items[vertex], vertex);
}
