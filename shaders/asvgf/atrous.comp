#version 460
#extension GL_GOOGLE_include_directive : require
// One iteration of the a-trous filter of gradients [Schied et al. 2018, section 4.3]: 3 x 3 strata, over like geometry. Changes and what
// they are measured by are filtered apart: noise cancels in the first, and those without a sample weigh nothing.
#include "asvgf/gradients.glsl"
#include "svgf/signals.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

ivec2 middle(ivec2 stratum) { return min(stratum * int(kStratum) + 1, ivec2(frame.width, frame.height) - 1); }

void main() {
  const ivec2 stratum = ivec2(gl_GlobalInvocationID.xy);
  if (!inStrata(stratum)) return;
  const SurfaceTexel here = readSurface(history.surface, middle(stratum));
  const float depth_gradient = imageLoad(images_rgba16f[history.motion], middle(stratum)).w;
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int i = 0; i < 9; ++i) {
    const ivec2 offset = ivec2(i % 3, i / 3) - 1, at = stratum + offset * int(gradient_.stride);
    if (!inStrata(at)) continue;
    const float pixels = float(kStratum * gradient_.stride) * length(vec2(offset));
    float w = (offset.x == 0 ? 0.5 : 0.25) * (offset.y == 0 ? 0.5 : 0.25);
    if (i != 4) w *= geometryWeight(here, readSurface(history.surface, middle(at)), depth_gradient, pixels);
    sum += w * imageLoad(images_rgba16f[gradient_.source], at);
    weight += w;
  }
  imageStore(images_rgba16f[gradient_.target], stratum, sum / weight);
}
