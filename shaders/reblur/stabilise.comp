#version 460
#extension GL_GOOGLE_include_directive : require
// Temporal stabilisation: the luminance that was shown at the surface's place goes on, cut to what its neighbourhood has now, as in
// temporal anti-aliasing. It is shown, and not accumulated; what it says of the history is how old that may be.
#include "reblur/reblur.glsl"
#include "svgf/picture.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kDeviations = 2.0;
const float kMostShare = 0.9;  // of what was shown

// What was shown of the surface in the tick before; w: 0 where it was not.
vec3 shownBefore(ivec2 pixel, SurfaceTexel here) {
  vec3 sum = vec3(0.0);
  if (history.known == 0u) return sum;
  const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
  const vec2 at = vec2(pixel) + motion.xy;
  const ivec2 corner = ivec2(floor(at));
  const vec2 f = at - vec2(corner);
  for (int i = 0; i < 4; ++i) {
    const ivec2 offset = ivec2(i & 1, i >> 1), texel = corner + offset;
    const vec2 bilinear = mix(1.0 - f, f, vec2(offset));
    if (!inPicture(texel) || !continuesSurface(readSurface(history.previous_surface, texel), here, here.depth + motion.z, motion.w)) continue;
    const vec4 shown = vec4(imageLoad(images_rg16f[history.stabilised], texel).xy, 0.0, 0.0);
    if (isNumber(shown)) sum += bilinear.x * bilinear.y * vec3(shown.xy * history.rescale, 1.0);
  }
  return sum.z > 0.0 ? vec3(sum.xy / sum.z, sum.z) : sum;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  Lobes light = readLobes(filter_.source, pixel);
  vec2 shown = luminances(light);
  if (here.depth > 0.0) {
    vec2 mean = vec2(0.0), square = vec2(0.0);
    float count = 0.0;
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x) {
        const ivec2 at = pixel + ivec2(x, y);
        if (!inPicture(at)) continue;
        const vec2 l = luminances(readLobes(filter_.source, at));
        mean += l;
        square += l * l;
        count += 1.0;
      }
    mean /= count;
    const vec2 reach = kDeviations * sqrt(max(square / count - mean * mean, vec2(0.0)));
    const vec3 before = shownBefore(pixel, here);
    const vec2 ticks = gatheredTicks(pixel);
    if (before.z > 0.0) {
      const vec2 fitting = clamp(before.xy, mean - reach, mean + reach);
      // A young history is followed at once.
      const vec2 share = kMostShare * clamp((ticks - 1.0) / (ticks + 1.0), 0.0, 1.0);
      for (uint s = 0u; s < kSignals; ++s) {
        const float l = mix(shown[s], fitting[s], share[s]);
        if (shown[s] > 1e-6) light.rgb[s] *= l / shown[s];
        shown[s] = l;
      }
    }
  }
  imageStore(images_rg16f[history.spare_deviation], pixel, vec4(min(shown, vec2(kMostStored)), 0.0, 0.0));
  showPicture(pixel, LobeLight(light.rgb, vec2(0.0)));
}
