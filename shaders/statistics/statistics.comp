#version 460
#extension GL_GOOGLE_include_directive : require
// Sums up what the paths of this tick cost: rays by kind.
#include "lib/bindless.glsl"
#include "lib/extra_samples.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

const uint kKinds = 3u;
shared uint sums[kKinds];

// The pixel that this thread looks at: all of them, or those of a round of further paths.
bool tookPath(out uvec2 pixel) {
  pixel = gl_GlobalInvocationID.xy;
  if (push.listed == 0u) return pixel.x < frame.width && pixel.y < frame.height;
  const uint index = gl_WorkGroupID.x * kPathGroup + gl_LocalInvocationIndex;
  if (index >= extraPathsOfRound()) return false;
  pixel = extraPixel(index);
  return true;
}

void main() {
  if (gl_LocalInvocationIndex < kKinds) sums[gl_LocalInvocationIndex] = 0u;
  barrier();
  uvec2 pixel;
  if (tookPath(pixel)) {
    const uint info = imageLoad(images_r32ui[frame.path_info], ivec2(pixel)).x;
    for (uint i = 0u; i < kKinds; ++i) {
      const uint count = info >> 8u * i & 0xffu;
      if (count > 0u) atomicAdd(sums[i], count);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    ViewStateRef view = ViewStateRef(frame.view_state);
    atomicAdd(view.state.bounce_rays, sums[0]);
    atomicAdd(view.state.shadow_rays, sums[1]);
    atomicAdd(view.state.retrace_rays, sums[2]);
  }
}
