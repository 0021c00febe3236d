#version 460
#extension GL_GOOGLE_include_directive : require
// History fix: where little has been gathered, as behind what has just moved away, the mean of a wide neighbourhood stands in: the
// coarser, the younger the history is.
#include "reblur/reblur.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const float kOld = 4.0;           // ticks: such a history needs no help
const float kLeastWeight = 0.05;  // of the texels that fit: with less, look at a finer level

// The level's four texels around the pixel, bilinear, as far as their surface is the pixel's. False: it is not.
bool fromLevel(ivec2 pixel, SurfaceTexel here, vec4 motion, uint level, out Lobes light) {
  const int stride = 2 << level;
  const vec2 at = (vec2(pixel) + 0.5) / float(stride) - 0.5;
  const ivec2 corner = ivec2(floor(at));
  const vec2 f = at - vec2(corner);
  const ivec2 size = (ivec2(frame.width, frame.height) + stride - 1) / stride;
  light = Lobes(vec3[](vec3(0.0), vec3(0.0)));
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    const ivec2 offset = ivec2(i & 1, i >> 1), texel = clamp(corner + offset, ivec2(0), size - 1), middle = middleOf(texel, stride);
    const vec2 bilinear = mix(1.0 - f, f, vec2(offset));
    const SurfaceTexel there = readSurface(history.surface, middle);
    const float w = bilinear.x * bilinear.y * geometryWeight(here, there, motion.w, distance(vec2(middle), vec2(pixel)));
    const Lobes l = readLobes(history.mips[level], texel);
    for (uint s = 0u; s < kSignals; ++s) light.rgb[s] += w * l.rgb[s];
    sum += w;
  }
  if (sum < kLeastWeight) return false;
  for (uint s = 0u; s < kSignals; ++s) light.rgb[s] /= sum;
  return true;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  const vec2 ticks = imageLoad(images_rg16f[history.sampled_deviation], pixel).xy;
  Lobes light = readLobes(filter_.source, pixel);
  if (here.depth > 0.0 && min(ticks.x, ticks.y) < kOld) {
    const vec4 motion = imageLoad(images_rgba16f[history.motion], pixel);
    // As the blurs' radii: small pictures have smaller things.
    const float levels = clamp(float(kHistoryMips) + 0.5 * log2(float(frame.height) / 1080.0), 1.0, float(kHistoryMips));
    for (uint s = 0u; s < kSignals; ++s) {
      // A mirror's picture has no wide mean.
      const float width = s == 1u ? clamp(roughnessAt(pixel) * 4.0, 0.0, 1.0) : 1.0;
      Lobes wide;
      for (int level = int(ceil(levels * width * (1.0 - ticks[s] / kOld))) - 1; level >= 0; --level)
        if (fromLevel(pixel, here, motion, uint(level), wide)) {
          light.rgb[s] = wide.rgb[s];
          break;
        }
    }
  }
  writeLobes(filter_.target, pixel, light, 0.5);
  keepTicks(pixel, ticks);
}
