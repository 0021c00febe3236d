#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require
// Lists the pixels that get further paths, those that get most first; neighbours stay near each other. And how many each round has.
#include "lib/bindless.glsl"
#include "lib/extra_samples.glsl"

layout(local_size_x = kPathGroup) in;

shared uint listed[kMostExtraPaths + 1u], starts[kMostExtraPaths + 1u];

void main() {
  const uint thread = gl_LocalInvocationIndex;
  ExtraSamplesRef extra = ExtraSamplesRef(frame.extra_samples);
  uvec2 pixel;
  uint paths = 0u;
  if (tiledPixel(gl_GlobalInvocationID.x, pixel))
    paths = imageLoad(images_r32ui[frame.path_info], ivec2(pixel)).x >> kExtraPathsShift & kExtraPathsMask;
  if (thread <= kMostExtraPaths) listed[thread] = 0u;
  barrier();
  uint place = 0u;
  for (uint n = 1u; n <= kMostExtraPaths; ++n) {
    const uvec4 alike = subgroupBallot(paths == n);
    uint start = 0u;
    if (subgroupElect()) start = atomicAdd(listed[n], subgroupBallotBitCount(alike));
    start = subgroupBroadcastFirst(start);
    if (paths == n) place = start + subgroupBallotExclusiveBitCount(alike);
  }
  barrier();

  if (thread > 0u && thread <= kMostExtraPaths) {
    uint before = 0u;  // pixels that get more
    for (uint n = thread + 1u; n <= kMostExtraPaths; ++n) before += extra.samples.wanted[n];
    if (listed[thread] > 0u) starts[thread] = before + atomicAdd(extra.samples.listed[thread], listed[thread]);
    if (gl_WorkGroupID.x == 0u) {
      const uint all = before + extra.samples.wanted[thread];
      extra.samples.rounds[thread - 1u].paths = all;
      extra.samples.rounds[thread - 1u].groups = (all + kPathGroup - 1u) / kPathGroup;
    }
  }
  barrier();
  PathPixelTable list = PathPixelTable(frame.extra_pixels);
  if (paths > 0u) list.items[starts[paths] + place] = pixel.y * frame.width + pixel.x;
}
