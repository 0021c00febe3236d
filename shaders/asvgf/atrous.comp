#version 460
#extension GL_GOOGLE_include_directive : require
// One iteration of the a-trous filter of gradients [Schied et al. 2018, section 4.3]: 3 x 3 strata, over like geometry. Changes and what
// they are measured by are filtered apart: noise cancels in the first, and those without a sample weigh nothing. The last iteration
// leaves the quotient of the two.
#include "asvgf/gradients.glsl"
#include "svgf/signals.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

SurfaceTexel surfaceOf(ivec2 stratum) { return readSurface(history.spare, placeOf(kGradientSurfaces, stratum)); }

void main() {
  const ivec2 stratum = ivec2(gl_GlobalInvocationID.xy);
  if (!inStrata(stratum)) return;
  const uint source = gradient_.iteration % 2u == 0u ? kGradientsHere : kGradientsThere, target = kGradientsThere - source;
  const int stride = 1 << gradient_.iteration;
  const SurfaceTexel here = surfaceOf(stratum);
  const float depth_gradient = imageLoad(images_rgba16f[history.motion], middleOf(stratum)).w;
  vec4 sum = vec4(0.0);
  float weight = 0.0;
  for (int i = 0; i < 9; ++i) {
    const ivec2 offset = ivec2(i % 3, i / 3) - 1, at = stratum + offset * stride;
    if (!inStrata(at)) continue;
    const float pixels = float(int(kStratum) * stride) * length(vec2(offset));
    float w = (offset.x == 0 ? 0.5 : 0.25) * (offset.y == 0 ? 0.5 : 0.25);
    if (i != 4) w *= geometryWeight(here, surfaceOf(at), depth_gradient, pixels);
    sum += w * unpackHalf4(imageLoad(images_rg32ui[history.spare], placeOf(source, at)).xy);
    weight += w;
  }
  const vec4 gradient = sum / weight;
  if (gradient_.iteration + 1u < kGradientIterations)
    imageStore(images_rg32ui[history.spare], placeOf(target, stratum), uvec4(packHalf4(gradient), 0u, 0u));
  else
    imageStore(images_rg8[history.changes], stratum, vec4(abs(gradient.xz) / max(gradient.yw, vec2(1e-6)), 0.0, 0.0));
}
