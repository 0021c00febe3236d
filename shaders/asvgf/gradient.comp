#version 460
#extension GL_GOOGLE_include_directive : require
// The temporal gradient of each stratum [Schied et al. 2018, section 4.2]: what its sample shows now, less what it showed in the tick
// before with the same random numbers; and the larger of the two, which it is measured by.
#include "asvgf/gradients.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  const uvec2 stratum = gl_GlobalInvocationID.xy;
  if (!inStrata(ivec2(stratum))) return;
  vec4 gradient = vec4(0.0);
  const uint claim = claimOf(stratum);
  if (claim != 0u) {
    const ivec2 pixel = ivec2(claimedPixel(claim, stratum));
    const LobeLight light = sampledLight(pixel);
    const vec2 now = vec2(luminance(light.rgb[0]), luminance(light.rgb[1]));
    const vec2 before = gradientSample(claimedSample(claim)).luminance * history.rescale;
    const vec2 change = now - before, larger = max(now, before);
    if (light.deviation.x > 0.0) gradient = vec4(change.x, larger.x, change.y, larger.y);
  }
  imageStore(images_rgba16f[gradient_.target], ivec2(stratum), clamp(gradient, -kMostStored, kMostStored));
}
