#version 460
#extension GL_GOOGLE_include_directive : require
// One level of the mips that the history fix reads: the mean of four texels, as far as they show the surface in the middle.
#include "reblur/reblur.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

float likeness(SurfaceTexel a, SurfaceTexel b, float gradient, float pixels) { return geometryWeight(a, b, gradient, pixels); }

void main() {
  const ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  const int stride = int(filter_.stride);
  const ivec2 size = ivec2(frame.width, frame.height);
  if (any(greaterThanEqual(texel * stride, size))) return;
  const ivec2 middle = middleOf(texel, stride);
  const SurfaceTexel here = readSurface(history.surface, middle);
  const float gradient = gradientAt(middle);
  Lobes mean = Lobes(vec3[](vec3(0.0), vec3(0.0)));
  float sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    const ivec2 child = texel * 2 + ivec2(i & 1, i >> 1);
    if (any(greaterThanEqual(child * (stride / 2), size))) continue;
    const ivec2 at = stride == 2 ? child : middleOf(child, stride / 2);
    // Where they all show other surfaces, better some light than none.
    const float w = 1e-4 + (at == middle ? 1.0 : likeness(here, readSurface(history.surface, at), gradient, distance(vec2(at), vec2(middle))));
    const Lobes light = readLobes(filter_.source, child);
    for (uint s = 0u; s < kSignals; ++s) mean.rgb[s] += w * light.rgb[s];
    sum += w;
  }
  for (uint s = 0u; s < kSignals; ++s) mean.rgb[s] /= sum;
  writeLobes(filter_.target, texel, mean, 0.5);
}
