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
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer CounterTable { uint items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer PartTable { RasterPart items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ShareTable { RasterShare items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer RasterCountsRef { RasterCounts counts; };

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

// In 1/256 pixel, along the rows or the columns.
int longestSide(ScreenTriangle t) {
  const ivec2 reach = max(max(t.corners[0], t.corners[1]), t.corners[2]) - min(min(t.corners[0], t.corners[1]), t.corners[2]);
  return max(reach.x, reach.y);
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

void keepKey(ivec2 pixel, uint64_t key) {
  if (kIntoShadowMap) {
    imageAtomicMax(images_r32ui[raster.image], shadowTexel(pixel), uint(key >> 32));
  } else {
    KeyTable keys = KeyTable(raster.keys);
    atomicMax(keys.items[keyAt(pixel)], key);
  }
}
void keepNearest(ivec2 pixel, float depth, uint id) { keepKey(pixel, keyOf(depth, id)); }

// By weights of the corners on the screen. They sum to 1.
float depthOf(vec3 depth, vec3 w) { return depth.x + w.y * (depth.y - depth.x) + w.z * (depth.z - depth.x); }
bool isCutOut(Drawn d, InstanceRecord instance, vec3 w, vec3 per_w) {
  const vec3 on_surface = w * per_w;
  return isCutOut(d, instance, on_surface / (on_surface.x + on_surface.y + on_surface.z));
}

void drawPixel(ivec2 pixel, vec3 w, ScreenTriangle t, uint id, Drawn d, InstanceRecord instance) {
  const float depth = depthOf(t.depth, w);
  if (!isHidden(pixel, depth, id) && !(isMasked(id) && isCutOut(d, instance, w, t.per_w))) keepNearest(pixel, depth, id);
}

// Twice the area left of the line from `a` to `b`, seen from `p`.
#define HELIO_EDGE(Int, Int2)                                                                                            \
  Int edge(Int2 a, Int2 b, Int2 p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); }
HELIO_EDGE(int, ivec2)
HELIO_EDGE(int64_t, i64vec2)

// Edge functions: at a pixel, none of them negative within the triangle, and what they change by from pixel to pixel. Int: what they
// fit in; factors always fit in an int.
#define HELIO_EDGES(Edges, Int, Int2, Int3)                                                                              \
  struct Edges {                                                                                                         \
    Int3 at;                                                                                                             \
    Int3 across, down;                                                                                                   \
    float area;  /* their sum; 0: no pixel */                                                                            \
  };                                                                                                                     \
  Edges edgesAt(ScreenTriangle t, Int2 pixel) {                                                                          \
    const Int2 c[3] = Int2[](Int2(t.corners[0]), Int2(t.corners[1]), Int2(t.corners[2]));                                \
    const Int area = edge(c[0], c[1], c[2]), turn = area < 0 ? -1 : 1, step = turn * (1 << kSubpixelBits);               \
    const Int2 p = pixel * (1 << kSubpixelBits);                                                                         \
    Edges e;                                                                                                             \
    e.at = turn * Int3(edge(c[1], c[2], p), edge(c[2], c[0], p), edge(c[0], c[1], p));                                   \
    e.across = -step * Int3(c[2].y - c[1].y, c[0].y - c[2].y, c[1].y - c[0].y);                                          \
    e.down = step * Int3(c[2].x - c[1].x, c[0].x - c[2].x, c[1].x - c[0].x);                                             \
    e.area = abs(float(area));                                                                                           \
    return e;                                                                                                            \
  }                                                                                                                      \
  void draw(ScreenTriangle t, ivec4 bounds, Edges edges, uint id, Drawn d, InstanceRecord instance) {                    \
    if (edges.area == 0.0) return;                                                                                       \
    for (int y = bounds.y; y <= bounds.w; ++y, edges.at += edges.down) {                                                 \
      Int3 e = edges.at;                                                                                                 \
      for (int x = bounds.x; x <= bounds.z; ++x, e += edges.across)                                                      \
        if (e.x >= 0 && e.y >= 0 && e.z >= 0) drawPixel(ivec2(x, y), vec3(e) / edges.area, t, id, d, instance);          \
    }                                                                                                                    \
  }
HELIO_EDGES(SmallEdges, int, ivec2, ivec3)
HELIO_EDGES(LargeEdges, int64_t, i64vec2, i64vec3)

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

// False: the pixel is not in it. `w`: weights on the surface.
bool hasPixel(CrossingTriangle t, ivec2 pixel, out vec3 w, out float depth) {
  const vec3 p = vec3(pixel, 1.0), e = vec3(dot(t.edges[0], p), dot(t.edges[1], p), dot(t.edges[2], p));
  const float sum = e.x + e.y + e.z;
  w = e / sum;
  depth = sum * t.scale;
  return all(greaterThanEqual(e, -t.slack)) && sum > 0.0;
}

void draw(CrossingTriangle t, ivec4 bounds, uint id, Drawn d, InstanceRecord instance) {
  vec3 w;
  float depth;
  for (int y = bounds.y; y <= bounds.w; ++y)
    for (int x = bounds.x; x <= bounds.z; ++x) {
      const ivec2 pixel = ivec2(x, y);
      if (hasPixel(t, pixel, w, depth) && !isHidden(pixel, depth, id) && !(isMasked(id) && isCutOut(d, instance, w)))
        keepNearest(pixel, depth, id);
    }
}

// ---- Tiles of the picture ----

ivec2 tilesAcross() { return (ivec2(raster.width, raster.height) + (1 << kTileBits) - 1) >> int(kTileBits); }
ivec4 tilePixels(ivec2 tile) {
  const ivec2 low = tile << int(kTileBits);
  return ivec4(low, min(low + (1 << kTileBits), ivec2(raster.width, raster.height)) - 1);
}

uint tilesOfAVolume() { return uint(tilesAcross().x * tilesAcross().y); }
uint allTiles() { return kIntoShadowMap ? kShadowCascades * tilesOfAVolume() : tilesOfAVolume(); }

// Working memory (shared/raster.h).
RasterCountsRef rasterCounts() { return RasterCountsRef(raster.parts); }
CounterTable partsOfTiles() { return CounterTable(raster.parts + kRasterCountsBytes); }
CounterTable endsOfTiles() { return CounterTable(raster.parts + kRasterCountsBytes + 4ul * allTiles()); }
ShareTable shares() { return ShareTable(raster.parts + kRasterCountsBytes + uint64_t(kRasterTileBytes) * allTiles()); }
PartTable parts() {
  return PartTable(uint64_t(shares()) + uint64_t(kRasterShareBytes) * (allTiles() + raster.part_capacity / kShareParts));
}
CounterTable inOrder() { return CounterTable(uint64_t(parts()) + 8ul * raster.part_capacity); }
// Before parts have an order, triangles lie in its place.
uint spreadCapacity() { return raster.part_capacity / (kIntoShadowMap ? kShadowCascades : 1u); }
CounterTable spreadTriangles() { return CounterTable(uint64_t(inOrder()) + 4ul * raster.cascade * spreadCapacity()); }

#endif
