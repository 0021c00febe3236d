#version 460
#extension GL_GOOGLE_include_directive : require
// Light path guided culling at work, for those who want to see it (shared/culling_view.h says what there is).
#include "lib/camera.glsl"
#include "lib/seen.glsl"
#include "shared/culling_view.h"
#include "shared/lipac.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 47) const uint kShown = kCullingViewStates;

layout(buffer_reference, scalar) readonly buffer LipacTickRef { LipacTick tick; };
layout(buffer_reference, scalar) readonly buffer WordTable { uint items[]; };
layout(buffer_reference, scalar) readonly buffer HitboxTable { Hitbox items[]; };
#define lipac LipacTickRef(frame.culling).tick
#include "lib/lipac_grid.glsl"

const vec3 kOfState[kStates] =
    vec3[](vec3(0.16, 0.25, 0.55), vec3(0.85, 0.65, 0.05), vec3(0.8, 0.08, 0.05), vec3(0.1, 0.6, 0.2));
const vec3 kOfUntraced = vec3(0.9, 0.35, 0.02);
const vec3 kDark = vec3(0.01);

bool isActive(uint word) { return (word & 3u) == kStateActive; }

// 0 to 1, by the logarithm of smoothed hits.
float heat(uint word) { return log2(1.0 + float(word >> kSmoothedShift) / float(kHitUnit)) / 16.0; }

vec3 ofHitbox(uint word) {
  return isActive(word) ? mix(vec3(0.35, 0.02, 0.0), vec3(1.0, 0.9, 0.5), heat(word))
                        : mix(vec3(0.02, 0.03, 0.08), vec3(0.1, 0.35, 1.0), heat(word));
}

// The grid, north up, as high as the picture; the viewer as a white dot.
vec3 fromAbove(uvec2 pixel) {
  const vec2 sides = vec2(lipac.grid_blocks_x, lipac.grid_blocks_z) * float(kCellMetres << kBlockBits);
  const vec2 corner = vec2(lipac.grid_x, lipac.grid_z) * float(kCellMetres);
  const vec2 size = vec2(frame.width, frame.height);
  const float scale = max(sides.x / size.x, sides.y / size.y);
  const vec2 place = corner + 0.5 * sides + (vec2(pixel) + 0.5 - 0.5 * size) * scale;
  if (distance(place, frame.position.xz) < 3.0 * scale) return vec3(1.0);
  const uint cell = cellAt(vec3(place.x, 0.0, place.y));
  if (cell == kNoCell) return kDark;
  const Hitbox hitbox = HitboxTable(lipac.cells).items[cell];
  const bool empty = !isActive(hitbox.word) && hitbox.lowest > hitbox.highest;
  return empty ? kDark : ofHitbox(hitbox.word);
}

vec3 ofSurface(uvec2 pixel) {
  Hit hit = seenHit(pixel);
  if (hit.primitive == kNothing) return kDark;
  const InstanceRecord instance = InstanceTable(frame.instances).items[hit.slot];
  const vec3 direction = cameraDirection(pixel);
  const Triangle t = seenTriangle(hit, instance, direction);
  const vec3 normal = normalize(cross(t.p[1] - t.p[0], t.p[2] - t.p[0]));
  vec3 color = kOfState[kStateActive];
  if (kShown == kCullingViewUntraced)
    color = WordTable(lipac.untraced).items[hit.slot] != 0u ? kOfUntraced : vec3(0.3);
  else if (kShown == kCullingViewStates)
    color = kOfState[WordTable(lipac.words).items[hit.slot] & 3u];
  else {
    const uint cell = cellAt(t.p[0] * weights(hit).x + t.p[1] * weights(hit).y + t.p[2] * weights(hit).z);
    if (cell != kNoCell) {
      const uint word = HitboxTable(lipac.cells).items[cell].word;
      color = kOfState[word & 3u] * (0.3 + 1.2 * heat(word));
    }
  }
  return color * (0.4 + 0.6 * abs(dot(normal, direction)));
}

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (pixel.x >= frame.width || pixel.y >= frame.height) return;
  vec3 shown = kDark;
  if (kShown == kCullingViewRays) {
    const uint info = imageLoad(images_r32ui[frame.path_info], ivec2(pixel)).x;
    shown = vec3(info & 0xffu, info >> 8 & 0xffu, info >> 16 & 0xffu) / 8.0;
  } else if (frame.culling != 0ul) {
    if (kShown == kCullingViewAbove) shown = fromAbove(pixel);
    else shown = ofSurface(pixel);
  }
  imageStore(images_rgba32f[frame.radiance], ivec2(pixel), vec4(shown, 1.0));
}
