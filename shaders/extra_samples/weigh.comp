#version 460
#extension GL_GOOGLE_include_directive : require
// A tile of pixels: whose light is young, and how noisy this tick's first sample is there. The deviation is that of luminance, with
// the tile's mean albedos, so that a texture is no noise, and without the sun's, so that the edge of a shadow is none; over what is
// seen, since eyes and errors are relative.
#include "extra_samples/young.glsl"
#include "lib/extra_samples.glsl"

const uint kPixels = kExtraTile * kExtraTile, kKinds = 2u;
layout(local_size_x = kExtraTile, local_size_y = kExtraTile) in;

const float kDark = 0.01;  // of white, squared: noise on what is darker is not seen

struct Sums {
  float count, first, second;  // of luminance
  float shown;                 // with the sun's
};
shared uint young[kPixels / 32u];
shared vec3 albedos[kPixels];         // of both lobes, luminance; and whether a surface is there
shared Sums kinds[kKinds][kPixels];

vec3 meanAlbedos(uint thread) {
  for (uint half_ = kPixels / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (thread < half_) albedos[thread] += albedos[thread + half_];
  }
  barrier();
  return albedos[0] / max(albedos[0].z, 1.0);
}

void addUp(uint to, uint from) {
  for (uint kind = 0u; kind < kKinds; ++kind) {
    const Sums a = kinds[kind][to], b = kinds[kind][from];
    kinds[kind][to] = Sums(a.count + b.count, a.first + b.first, a.second + b.second, a.shown + b.shown);
  }
}

void sumUp(uint thread) {
  for (uint half_ = kPixels / 2u; half_ > 0u; half_ /= 2u) {
    barrier();
    if (thread < half_) addUp(thread, thread + half_);
  }
  barrier();
}

uint noiseOf(uint kind) {
  const Sums s = kinds[kind][0];
  if (s.count < 2.0) return 0u;
  const float mean = s.shown / s.count, squares = max(s.second - s.first * s.first / s.count, 0.0);
  return noiseBin(sqrt(squares / (s.count - 1.0) / (mean * mean + kDark)));
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  const uint thread = gl_LocalInvocationIndex;
  if (thread < kPixels / 32u) young[thread] = 0u;
  barrier();
  SurfaceTexel here = SurfaceTexel(0u, 0.0, false, 0.0);
  if (inPicture(pixel)) here = readSurface(history.surface, pixel);
  const bool seen = here.depth > 0.0;
  if (seen && gatheredBefore(pixel, here) < float(kYoungTicks)) atomicOr(young[thread / 32u], 1u << thread % 32u);
  barrier();
  ExtraTileTable tiles = ExtraTileTable(frame.extra_tiles);
  const uint tile = gl_WorkGroupID.y * extraTiles().x + gl_WorkGroupID.x;
  if ((young[0] | young[1]) == 0u) {  // for all threads alike
    if (thread == 0u) tiles.items[tile] = ExtraTile(0u, uint[](0u, 0u));
    return;
  }

  albedos[thread] = vec3(0.0);
  LobeLight light = LobeLight(vec3[](vec3(0.0), vec3(0.0)), vec2(0.0));
  if (seen) {
    const uvec2 packed_albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
    albedos[thread] = vec3(luminance(unpackAlbedo(packed_albedos.x)), luminance(unpackAlbedo(packed_albedos.y)), 1.0);
    light = sampledLight(pixel);
  }
  const vec3 mean = meanAlbedos(thread);
  const float l = dot(vec2(luminance(light.rgb[0]), luminance(light.rgb[1])), mean.xy);
  float shown = l;
  if (seen && history.sunlight != 0u) shown += here.sunlit * dot(imageLoad(images_rg16f[history.sunlight], pixel).xy, mean.xy);
  const uint own = extraKind(uvec2(pixel));
  for (uint kind = 0u; kind < kKinds; ++kind)
    kinds[kind][thread] = kind == own && light.deviation.x > 0.0 ? Sums(1.0, l, l * l, shown) : Sums(0.0, 0.0, 0.0, 0.0);
  sumUp(thread);
  if (thread != 0u) return;

  // The one kind's noise is what the other kind's samples say.
  const uint bins[kKinds] = uint[](noiseOf(1u), noiseOf(0u));
  tiles.items[tile] = ExtraTile(bins[0] | bins[1] << 8, young);
  ExtraSamplesRef extra = ExtraSamplesRef(frame.extra_samples);
  // Kinds alternate, and every other row begins with the other: bits of 0x55 and 0xaa in turn.
  const uvec2 bits = uvec2(young[0], young[1]);
  for (uint kind = 0u; kind < kKinds; ++kind) {
    const uvec2 of_kind = bits & (kind == 0u ? 0xaa55aa55u : 0x55aa55aau);
    const uint count = uint(bitCount(of_kind.x) + bitCount(of_kind.y));
    if (count > 0u) atomicAdd(extra.samples.young[bins[kind]], count);
  }
}
