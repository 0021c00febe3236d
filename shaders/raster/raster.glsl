// A triangle on the screen, and how its pixels are found. Corners lie on a lattice of 1/256 pixel, so edge functions are integers:
// neighbours that share an edge leave no gap between them. Pixels on an edge belong to both; the nearest wins, and of the equally near
// the one that was listed last, whatever the order in which threads come.
#ifndef HELIO_RASTER_GLSL
#define HELIO_RASTER_GLSL
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#define HELIO_OWN_PUSH
#include "lib/bindless.glsl"
#include "lib/tables.glsl"
#include "shared/draw.h"
#include "shared/raster.h"

layout(push_constant, scalar) uniform Raster { RasterConstants raster; };
#define frame FrameRef(raster.frame).constants

#include "lib/cut_out.glsl"
#include "lib/place.glsl"

// A shadow map, or what the camera sees.
layout(constant_id = 60) const bool kIntoShadowMap = false;

layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CommandTable { DrawCommand items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer CountRef { DrawCounts counts; };
layout(buffer_reference, scalar, buffer_reference_align = 8) buffer KeyTable { uint64_t items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TileCountRef { RasterTileCount count; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer TileTable { RasterTile items[]; };

const uint64_t kTilesAt = 4ul;  // behind RasterTileCount
const float kSubpixels = float(1u << kSubpixelBits);
const float kFarthestCorner = 4.0e6;     // pixels: beyond it a corner has no place on the lattice
const float kCrossingTolerance = 1.0 / kSubpixels;  // pixels: twice as far as rounding moves a corner along an axis

// ---- Which triangle ----

struct Drawn {
  DrawRecord record;
  uint slot;
  uint primitive;  // of the geometry
};

// What lies behind the commands: each one's record, and its first triangle.
WordTable commandRecords() { return WordTable(raster.commands + uint64_t(kCommandBytes) * raster.draw_count); }
WordTable commandBegins() { return WordTable(raster.commands + uint64_t(kCommandBytes + 4u) * raster.draw_count); }

// The command whose triangles hold this one: the last that begins at or before it.
uint commandOf(uint triangle, uint first, uint count) {
  WordTable begins = commandBegins();
  uint low = 0u, high = count;  // it is one of these, `high` left out
  while (high - low > 1u) {
    const uint middle = (low + high) / 2u;
    if (begins.items[first + middle] <= triangle) low = middle;
    else high = middle;
  }
  return first + low;
}

Drawn drawnTriangle(uint id) {
  const DrawCounts counts = CountRef(raster.counts).counts;
  const bool masked = (id & kMaskedTriangle) != 0u;
  const uint triangle = id & ~kMaskedTriangle, first = masked ? raster.solid_draws : 0u;
  const uint at = commandOf(triangle, first, masked ? counts.masked : counts.solid);
  WordTable begins = commandBegins(), records = commandRecords();
  const uint begin = begins.items[at];
  Drawn d;
  d.record = DrawTable(raster.draws).items[records.items[at]];
  const uint triangles = d.record.index_count / 3u, instance = (triangle - begin) / triangles;
  d.slot = WordTable(raster.slots).items[CommandTable(raster.commands).items[at].first_instance + instance];
  d.primitive = triangle - begin - instance * triangles;
  return d;
}

uint cornerVertex(Drawn d, uint corner) { return IndexTable(raster.indices).items[d.record.first_index + 3u * d.primitive + corner]; }

vec4 clipCorner(Drawn d, InstanceRecord instance, uint corner) {
  const uint vertex = cornerVertex(d, corner);
  if (!kIntoShadowMap) return cameraClip(placeVertex(d.record, instance, vertex, frame.position), raster.jitter);
  const ShadowMap map = ShadowMapRef(raster.shadow_map).map;
  const ShadowCascade cascade = map.cascades[raster.cascade];
  return shadowClip(map, cascade, placeVertex(d.record, instance, vertex, cascade.centre));
}

// ---- On the screen ----

struct ScreenTriangle {
  ivec2 corners[3];  // 1/256 pixel; pixels' centres are at multiples of 256
  vec3 depth;        // at the corners
  vec3 per_w;        // what makes weights on the screen those on the surface
};

// In pixels times w: (0, 0) is the first pixel's centre.
vec2 onScreen(vec4 clip) { return (0.5 * clip.xy + 0.5 * clip.w) * vec2(raster.width, raster.height) - 0.5 * clip.w; }

// All corners lie beyond one side of the picture, or behind the eye.
bool isOutside(vec4 clip[3]) {
  bvec4 beyond = bvec4(true);
  bool behind = true;
  for (int i = 0; i < 3; ++i) {
    beyond = bvec4(beyond.x && clip[i].x > clip[i].w, beyond.y && -clip[i].x > clip[i].w, beyond.z && clip[i].y > clip[i].w,
                   beyond.w && -clip[i].y > clip[i].w);
    behind = behind && clip[i].z > clip[i].w;
  }
  return any(beyond) || (!kIntoShadowMap && behind);
}

// False: a corner is behind the eye, or too far beside it.
bool placeOnScreen(vec4 clip[3], out ScreenTriangle t) {
  for (int i = 0; i < 3; ++i) {
    if (!kIntoShadowMap && clip[i].w < clip[i].z) return false;
    const vec2 p = onScreen(clip[i]) / clip[i].w;
    if (max(abs(p.x), abs(p.y)) > kFarthestCorner) return false;
    t.corners[i] = ivec2(round(p * kSubpixels));
    t.depth[i] = clip[i].z / clip[i].w;
    t.per_w[i] = 1.0 / clip[i].w;
  }
  return true;
}

// Its pixels: the first and the last of each row and column. Empty: the last before the first.
ivec4 pixelBounds(ScreenTriangle t) {
  const ivec2 low = min(min(t.corners[0], t.corners[1]), t.corners[2]), high = max(max(t.corners[0], t.corners[1]), t.corners[2]);
  const int last = (1 << kSubpixelBits) - 1;
  return ivec4(max((low + last) >> int(kSubpixelBits), ivec2(0)), min(high >> int(kSubpixelBits), ivec2(raster.width, raster.height) - 1));
}

bool isMasked(uint id) { return kAlphaMasks && (id & kMaskedTriangle) != 0u; }

bool isCutOut(Drawn d, InstanceRecord instance, vec3 weights) {
  const GeometryRecord geometry = GeometryTable(frame.geometries).items[geometryOf(d.record, instance)];
  return isCutOut(geometry, uvec3(cornerVertex(d, 0u), cornerVertex(d, 1u), cornerVertex(d, 2u)), weights);
}

ivec2 shadowTexel(ivec2 pixel) {
  return ivec2(raster.cascade % kShadowTilesPerRow, raster.cascade / kShadowTilesPerRow) * int(raster.width) + pixel;
}
uint keyAt(ivec2 pixel) { return uint(pixel.y) * raster.width + uint(pixel.x); }
uint64_t keyOf(float depth, uint id) { return uint64_t(floatBitsToUint(depth)) << 32 | uint64_t(id); }

// Not in the picture's depth, or something nearer is there already: what is read late is less than what is there.
bool isHidden(ivec2 pixel, float depth, uint id) {
  if (!(depth > 0.0 && depth <= 1.0)) return true;
  if (kIntoShadowMap) return imageLoad(images_r32ui[raster.image], shadowTexel(pixel)).x >= floatBitsToUint(depth);
  return KeyTable(raster.keys).items[keyAt(pixel)] >= keyOf(depth, id);
}

void keepNearest(ivec2 pixel, float depth, uint id) {
  if (kIntoShadowMap) {
    imageAtomicMax(images_r32ui[raster.image], shadowTexel(pixel), floatBitsToUint(depth));
  } else {
    KeyTable keys = KeyTable(raster.keys);
    atomicMax(keys.items[keyAt(pixel)], keyOf(depth, id));
  }
}

// What the weights on the screen say of a pixel. They sum to 1.
void drawPixel(ivec2 pixel, vec3 w, ScreenTriangle t, uint id, Drawn d, InstanceRecord instance) {
  const float depth = t.depth.x + w.y * (t.depth.y - t.depth.x) + w.z * (t.depth.z - t.depth.x);
  if (isHidden(pixel, depth, id)) return;
  if (isMasked(id)) {
    const vec3 on_surface = w * t.per_w;
    if (isCutOut(d, instance, on_surface / (on_surface.x + on_surface.y + on_surface.z))) return;
  }
  keepNearest(pixel, depth, id);
}

// Twice the area left of the line from `a` to `b`, seen from `p`.
#define HELIO_EDGE(Int, Int2)                                                                                            \
  Int edge(Int2 a, Int2 b, Int2 p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); }
HELIO_EDGE(int, ivec2)
HELIO_EDGE(int64_t, i64vec2)

// Draws the pixels `first`, `first` + `step`, ... of `bounds`, row by row, by what its edge functions change from the first pixel
// on. Int: what they fit in; factors always fit in an int.
#define HELIO_DRAW_PIXELS(name, Int, Int2, Int3)                                                                         \
  void name(ScreenTriangle t, ivec4 bounds, uint first, uint step, uint id, Drawn d, InstanceRecord instance) {          \
    const Int2 c[3] = Int2[](Int2(t.corners[0]), Int2(t.corners[1]), Int2(t.corners[2]));                                \
    const Int area = edge(c[0], c[1], c[2]);                                                                             \
    if (area == 0) return;                                                                                               \
    const uint width = uint(bounds.z - bounds.x + 1), count = width * uint(bounds.w - bounds.y + 1);                     \
    const ivec2 sides[3] = ivec2[](t.corners[2] - t.corners[1], t.corners[0] - t.corners[2], t.corners[1] - t.corners[0]); \
    const int turn = area < 0 ? -1 : 1;                                                                                  \
    const ivec3 across = -turn * ivec3(sides[0].y, sides[1].y, sides[2].y), down = turn * ivec3(sides[0].x, sides[1].x, sides[2].x); \
    const Int2 p = Int2(bounds.xy) * (1 << kSubpixelBits);                                                               \
    const Int3 e0 = Int(turn) * Int3(edge(c[1], c[2], p), edge(c[2], c[0], p), edge(c[0], c[1], p));                     \
    for (uint i = first; i < count; i += step) {                                                                         \
      const ivec2 moved = ivec2(i % width, i / width), by = moved * (1 << kSubpixelBits);                                \
      const Int3 e = e0 + Int3(across) * Int(by.x) + Int3(down) * Int(by.y);                                             \
      if (e.x < 0 || e.y < 0 || e.z < 0) continue;                                                                       \
      drawPixel(bounds.xy + moved, vec3(e) / abs(float(area)), t, id, d, instance);                                      \
    }                                                                                                                    \
  }
HELIO_DRAW_PIXELS(drawSmall, int, ivec2, ivec3)
HELIO_DRAW_PIXELS(drawLarge, int64_t, i64vec2, i64vec3)

// ---- What reaches behind the eye: homogeneous edge functions [Olano, Greer 1997] ----

struct CrossingTriangle {
  vec3 edges[3];  // (x, y, 1) . edge >= 0 for pixels within
  vec3 slack;     // of them: corners of neighbours were moved to the lattice
  float scale;    // of the edge functions' sum: depth
};

CrossingTriangle crossingTriangle(vec4 clip[3]) {
  vec3 corners[3];
  for (int i = 0; i < 3; ++i) corners[i] = vec3(onScreen(clip[i]), clip[i].w);
  CrossingTriangle t;
  for (int i = 0; i < 3; ++i) t.edges[i] = cross(corners[(i + 1) % 3], corners[(i + 2) % 3]);
  const float volume = dot(corners[0], t.edges[0]);
  for (int i = 0; i < 3; ++i) {
    if (volume < 0.0) t.edges[i] = -t.edges[i];
    t.slack[i] = kCrossingTolerance * (abs(t.edges[i].x) + abs(t.edges[i].y));
  }
  t.scale = volume == 0.0 ? 0.0 : clip[0].z / abs(volume);
  return t;
}

void drawCrossing(CrossingTriangle t, ivec4 bounds, uint first, uint step, uint id, Drawn d, InstanceRecord instance) {
  const uint width = uint(bounds.z - bounds.x + 1), count = width * uint(bounds.w - bounds.y + 1);
  for (uint i = first; i < count; i += step) {
    const ivec2 pixel = bounds.xy + ivec2(i % width, i / width);
    const vec3 p = vec3(pixel, 1.0), e = vec3(dot(t.edges[0], p), dot(t.edges[1], p), dot(t.edges[2], p));
    if (any(lessThan(e, -t.slack))) continue;
    const float sum = e.x + e.y + e.z;
    if (!(sum > 0.0)) continue;
    const float depth = sum * t.scale;
    if (isHidden(pixel, depth, id) || (isMasked(id) && isCutOut(d, instance, e / sum))) continue;
    keepNearest(pixel, depth, id);
  }
}

// ---- Tiles of the picture ----

ivec2 tilesAcross() { return (ivec2(raster.width, raster.height) + (1 << kTileBits) - 1) >> int(kTileBits); }
ivec4 tilePixels(ivec2 tile) {
  const ivec2 low = tile << int(kTileBits);
  return ivec4(low, min(low + (1 << kTileBits), ivec2(raster.width, raster.height)) - 1);
}

#endif
