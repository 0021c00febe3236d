#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_ballot : require
// Lists the paths that wait for a ray after launch `push.launch`, and counts them for the launch that traces it. Neighbours
// stay near each other, for the sake of coherent rays; of a group's paths those that go on come first and those that wait for
// no more than a shadow ray last, so that a GPU's lanes have the same to do.
#include "lib/bindless.glsl"
#include "lib/extra_samples.glsl"

layout(local_size_x = kPathGroup) in;

const uint kGoesOn = 0u, kShadowOnly = 1u, kDone = 2u;

shared uint listed[2], first;

// The pixel that this thread looks at; false: none.
bool candidate(uint index, out uvec2 pixel) {
  if (push.launch == 0u && push.listed == 0u) return tiledPixel(index, pixel);
  if (push.launch == 0u) {
    if (index >= extraPathsOfRound()) return false;
    pixel = extraPixel(index);
    return true;
  }
  if (index >= pathLaunch(push.launch).paths) return false;
  pixel = queuedPixel(push.launch, index);
  return true;
}

void main() {
  uvec2 pixel = uvec2(0u);
  uint kind = kDone;
  if (candidate(gl_GlobalInvocationID.x, pixel)) {
    const uint info = imageLoad(images_r32ui[frame.path_info], ivec2(pixel)).x;
    kind = (info & kPathGoesOn) != 0u ? kGoesOn : (info & kPathShadow) != 0u ? kShadowOnly : kDone;
  }

  // A place among the group's paths of this kind: the subgroup's part of them, then the thread's.
  if (gl_LocalInvocationIndex < 2u) listed[gl_LocalInvocationIndex] = 0u;
  barrier();
  uint place = 0u;
  for (uint k = kGoesOn; k <= kShadowOnly; ++k) {
    const uvec4 alike = subgroupBallot(kind == k);
    uint start = 0u;
    if (subgroupElect()) start = atomicAdd(listed[k], subgroupBallotBitCount(alike));
    start = subgroupBroadcastFirst(start);
    if (kind == k) place = start + subgroupBallotExclusiveBitCount(alike);
  }
  barrier();

  // The group's part of the list.
  const uint next = push.launch + 1u, count = listed[kGoesOn] + listed[kShadowOnly];
  if (gl_LocalInvocationIndex == 0u && count > 0u) {
    PathLaunchTable launches = PathLaunchTable(frame.path_launches);
    first = atomicAdd(launches.items[next].paths, count);
    atomicMax(launches.items[next].groups, (first + count + kPathGroup - 1u) / kPathGroup);
  }
  barrier();
  if (kind == kShadowOnly) place += listed[kGoesOn];
  if (kind != kDone) queuePixel(next, first + place, pixel);
}
