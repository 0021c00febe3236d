// The sun's visibility by its shadow map (shared/shadow_map.h).
#ifndef HELIO_SHADOW_MAP_GLSL
#define HELIO_SHADOW_MAP_GLSL
#include "lib/bindless.glsl"
#include "lib/shadow_map_table.glsl"
#include "lib/tables.glsl"

layout(constant_id = 44) const uint kSunShadow = kSunShadowRays;

const bool kUsesShadowMap = kSunShadow != kSunShadowRays;
const float kNormalTexels = 1.5;  // that a surface is lifted: its own texels lie on both sides of it
const float kDepthTexels = 1.0;

float casterDepth(ShadowMap map, ivec2 texel) {
  return map.bits != 0u ? uintBitsToFloat(imageLoad(images_r32ui[map.image], texel).x) : texelFetch(textures[map.image], texel, 0).r;
}

// Share of the sun that the map lets through to `p`, whose surface faces `normal` (0: no surface): bilinear over four
// comparisons, in the finest cascade that has it.
float sunThroughMap(vec3 p, vec3 normal) {
  const ShadowMap map = ShadowMapRef(frame.shadow_map).map;
  for (uint c = 0u; c < kShadowCascades; ++c) {
    const ShadowCascade cascade = map.cascades[c];
    const float texel = 2.0 * cascade.half_width / float(map.tile);
    const vec3 lifted = p + normal * (kNormalTexels * texel) - cascade.centre;
    const vec2 at = vec2(dot(lifted, map.right), dot(lifted, map.up)) / cascade.half_width;
    const float edge = 1.0 - 4.0 / float(map.tile);
    if (max(abs(at.x), abs(at.y)) > edge) continue;
    const float depth = 0.5 + 0.5 * (dot(lifted, map.to_sun) + kDepthTexels * texel) / map.half_depth;
    const vec2 place = (0.5 + 0.5 * at) * float(map.tile) - 0.5;
    const ivec2 corner = ivec2(floor(place));
    const vec2 f = place - vec2(corner);
    const ivec2 origin = corner + ivec2(c % kShadowTilesPerRow, c / kShadowTilesPerRow) * int(map.tile);
    float lit = 0.0;
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x)
        if (casterDepth(map, origin + ivec2(x, y)) <= depth)
          lit += (x == 0 ? 1.0 - f.x : f.x) * (y == 0 ? 1.0 - f.y : f.y);
    return lit;
  }
  return 1.0;
}

#endif
