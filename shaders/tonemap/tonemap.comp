#version 460
#extension GL_GOOGLE_include_directive : require
// Exposure, Khronos PBR Neutral tone mapping, sRGB, 8 bits with dither.
#include "lib/bindless.glsl"
#include "lib/random.glsl"
#include "lib/tables.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Khronos PBR Neutral tone mapper, specification of 2024: base colours below 0.8 keep hue and saturation.
vec3 pbrNeutral(vec3 c) {
  const float kStartCompression = 0.8 - 0.04;
  const float kDesaturation = 0.15;
  const float least = min(c.r, min(c.g, c.b));
  c -= least < 0.08 ? least - 6.25 * least * least : 0.04;
  const float peak = max(c.r, max(c.g, c.b));
  if (peak < kStartCompression) return c;
  const float d = 1.0 - kStartCompression;
  const float new_peak = 1.0 - d * d / (peak + d - kStartCompression);
  c *= new_peak / peak;
  return mix(c, vec3(new_peak), 1.0 - 1.0 / (kDesaturation * (peak - new_peak) + 1.0));
}

vec3 toSrgb(vec3 c) { return mix(1.055 * pow(max(c, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055, 12.92 * c, lessThanEqual(c, vec3(0.0031308))); }

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= frame.width || pixel.y >= frame.height) return;
  const float exposure = push.auto_exposure != 0u ? ViewStateRef(frame.view_state).state.exposure : push.exposure_bias;
  const vec3 radiance = imageLoad(images_rgba32f[push.source], ivec2(pixel)).rgb;
  vec3 display = clamp(push.curve == kCurveTone ? pbrNeutral(radiance * exposure) : radiance, 0.0, 1.0);
  if (push.curve == kCurveSigned) display = 0.5 + 0.5 * radiance / (1.0 + abs(radiance));
  else if (push.curve != kCurveNone) display = toSrgb(display);
  // Half a step of noise, the same in every frame, hides the steps that 8 bits make of a smooth sky. Numbers have none.
  const float noise = push.curve == kCurveNone || push.curve == kCurveSigned ? 0.0 : randomAt(pixel, 0u, 0u).x - 0.5;
  PixelTable(frame.pixels).items[pixel.y * frame.width + pixel.x] = packUnorm4x8(vec4(display + noise / 255.0, 1.0));
}
