#version 460
#extension GL_GOOGLE_include_directive : require
// The temporal gradient of each stratum [Schied et al. 2018, section 4.2]: what its sample shows now, less what it showed in the tick
// before with the same random numbers; and the larger of the two, which it is measured by. Beside it the surface in the stratum's
// middle, for the filter, whose taps then lie beside each other.
#include "asvgf/gradients.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  const uvec2 stratum = gl_GlobalInvocationID.xy;
  if (!inStrata(ivec2(stratum))) return;
  const uvec4 surface = imageLoad(images_rg32ui[history.surface], middleOf(ivec2(stratum)));
  imageStore(images_rg32ui[history.spare], placeOf(kGradientSurfaces, ivec2(stratum)), surface);
  vec4 gradient = vec4(0.0);
  const uint claim = claimOf(stratum);
  if (claim != 0u) {
    const ivec2 pixel = ivec2(claimedPixel(claim, stratum));
    const LobeLight light = sampledLight(pixel);
    // Rounded as what was kept is: what is the same is no change.
    const vec2 now = unpackHalf2x16(packHalf2x16(vec2(luminance(light.rgb[0]), luminance(light.rgb[1]))));
    const vec2 before = keptSample(claimedSample(claim)).luminance * history.rescale;
    const vec2 change = now - before, larger = max(now, before);
    if (light.deviation.x > 0.0) gradient = vec4(change.x, larger.x, change.y, larger.y);
  }
  imageStore(images_rg32ui[history.spare], placeOf(kGradientsHere, ivec2(stratum)), uvec4(packHalf4(clamp(gradient, -kMostStored, kMostStored)), 0u, 0u));
}
