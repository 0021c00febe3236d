// Indirect light at a lower rate than that of pixels: of each block of pixels one, in turn, follows its path beyond the surface that
// it shows, and leaves its ray and what came along it to all around it (indirect/reconstruct.comp).
#ifndef HELIO_INDIRECT_GLSL
#define HELIO_INDIRECT_GLSL
#include "lib/bsdf.glsl"
#include "lib/history.glsl"

layout(buffer_reference, scalar, buffer_reference_align = 4) buffer IndirectTable { IndirectSample items[]; };

const bool kSharesIndirect = kIndirectRate > kIndirectFull;
const uvec2 kIndirectBlock = uvec2(2u, kIndirectRate == kIndirectQuarter ? 2u : 1u);
// A ray whose pixel counts it, and that brings nothing: it went below the horizon.
const float kNothingCame = -1.0;

uint indirectIndex(uvec2 pixel) { return pixel.y * frame.width + pixel.x; }

// The pixel of a block whose turn it is.
uvec2 tracedPixel(uvec2 block) {
  const uint turn = push.seed + push.sample_index;
  const uvec2 quarter = uvec2((turn + 1u) >> 1u & 1u, turn & 1u), half_ = uvec2((turn + block.y) & 1u, 0u);
  return min(block * kIndirectBlock + (kIndirectRate == kIndirectQuarter ? quarter : half_), uvec2(frame.width, frame.height) - 1u);
}
bool followsIndirect(uvec2 pixel) { return tracedPixel(pixel / kIndirectBlock) == pixel; }

// A unit vector in 2 x 16 bits, octahedral; octahedral() of lib/math.glsl reads it.
uint packDirection(vec3 v) {
  vec2 e = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
  if (v.z < 0.0) e = (1.0 - abs(e.yx)) * vec2(e.x >= 0.0 ? 1.0 : -1.0, e.y >= 0.0 ? 1.0 : -1.0);
  return packSnorm2x16(e);
}

// The shown surface as others must know it; no ray yet.
void storeIndirectSurface(uvec2 pixel, vec3 view, Bsdf b) {
  IndirectTable(frame.indirect).items[indirectIndex(pixel)] =
      IndirectSample(packDirection(view), b.specular && !b.mirror ? b.alpha : 0.0, 0u, 0.0, 0u, 0u);
}
void storeNoIndirect(uvec2 pixel) { IndirectTable(frame.indirect).items[indirectIndex(pixel)].pdf = 0.0; }

// The ray that the path goes on with. `weights`: f |cos| over density and albedo, of the pixel's own diffuse and specular lobe.
void storeIndirectRay(uvec2 pixel, vec3 direction, float pdf, vec2 weights) {
  IndirectTable table = IndirectTable(frame.indirect);
  const uint index = indirectIndex(pixel);
  table.items[index].direction = packDirection(direction);
  table.items[index].pdf = pdf;
  table.items[index].weights = packHalf2x16(min(weights, vec2(kMostStored)));
}
void storeIndirectNothing(uvec2 pixel) { IndirectTable(frame.indirect).items[indirectIndex(pixel)].pdf = kNothingCame; }

// Light that came along the ray, in this launch.
void addIndirectLight(uvec2 pixel, vec3 light) {
  IndirectTable table = IndirectTable(frame.indirect);
  const uint index = indirectIndex(pixel);
  table.items[index].light = packLight(stored(unpackLight(table.items[index].light) + light * history.unit));
}

#endif
