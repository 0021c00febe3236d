#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Rasterising, fifth: a group draws its share of a tile's parts, a thread those of its block, whose pixels it holds until all are drawn.
// What lies behind the whole block costs no look at its pixels.
#include "raster/raster.glsl"

layout(local_size_x = kTileGroup) in;

const int kSide = int(kBlockSide), kBlock = kSide * kSide;

// How a triangle is drawn: by edge functions of the tile that fit in an int, else as if it were alone in the tile.
const uint kNowhere = 0u, kByTile = 1u, kAlone = 2u;
// 1/256 pixels from corner to corner. With L of them, and a tile's side S beside them, an edge function is 2 L (L + S) / 256 at most, and
// changes by 2 L S / 256 over the tile: together 1.8e9.
const int kLongest = 7 << 16;

// A triangle as the tile's threads need it. Pixels' centres are at multiples of 256 where edge functions have 1/256 pixel squared: they
// are kept without their lowest 8 bits, which changes no sign.
struct Part {
  ivec3 at, across, down;  // edge functions at the tile's first pixel, and what they change by from pixel to pixel
  ivec3 reach;             // that they rise within a block from its first pixel on
  vec3 low;                // bits that were left out
  float area;
  vec3 depth, per_w;
  uint nearest;  // bits of its nearest corner's depth
  uint id;
  uint way;
};
shared Part batch[kTileBatch];

uint64_t held[kBlock];  // keys of the block's pixels
uint farthest;          // of them, the depth's bits
uint changed;           // a bit a pixel

ivec2 pixelOf(ivec2 block, int i) { return block + ivec2(i % kSide, i / kSide); }
bool isInPicture(ivec2 pixel) { return pixel.x < int(raster.width) && pixel.y < int(raster.height); }

// Warps of 32 threads have blocks of 32 x 16 pixels: most of them skip the same triangles.
ivec2 blockOf(uint thread) {
  const uint x = bitfieldExtract(thread, 0, 3) | bitfieldExtract(thread, 5, 1) << 3, y = bitfieldExtract(thread, 3, 2) | (thread >> 6) << 2;
  return kSide * ivec2(x, y);
}

uint64_t load(ivec2 pixel) {
  if (!isInPicture(pixel)) return ~0ul;  // nothing is nearer
  if (kIntoShadowMap) return uint64_t(imageLoad(images_r32ui[raster.image], shadowTexel(pixel)).x) << 32;
  return KeyTable(raster.keys).items[keyAt(pixel)];
}

void findFarthest() {
  uint64_t least = held[0];
  [[unroll]] for (int i = 1; i < kBlock; ++i) least = min(least, held[i]);
  farthest = uint(least >> 32);
}

Part partOf(uint id, ivec2 tile) {
  const Drawn d = drawnTriangle(id);
  const InstanceRecord instance = InstanceTable(frame.instances).items[d.slot];
  const vec4 clip[3] = vec4[](clipCorner(d, instance, 0u), clipCorner(d, instance, 1u), clipCorner(d, instance, 2u));
  Part part;
  part.id = id;
  part.way = kAlone;
  ScreenTriangle t;
  if (!placeOnScreen(clip, t)) return part;
  if (longestSide(t) > kLongest) return part;
  const LargeEdges edges = edgesAt(t, i64vec2(tile));
  part.at = ivec3(edges.at >> kSubpixelBits);
  part.low = vec3(edges.at & ((1 << kSubpixelBits) - 1));
  part.across = ivec3(edges.across >> kSubpixelBits);
  part.down = ivec3(edges.down >> kSubpixelBits);
  part.reach = (kSide - 1) * (max(part.across, ivec3(0)) + max(part.down, ivec3(0)));
  part.area = edges.area;
  part.depth = t.depth;
  part.per_w = t.per_w;
  part.nearest = floatBitsToUint(max(max(max(t.depth.x, t.depth.y), t.depth.z), 0.0));
  part.way = part.area == 0.0 ? kNowhere : kByTile;
  return part;
}

// Keeps the nearest of what is held and the triangle at a pixel. Tells masked triangles apart only where they would be seen.
#define HELIO_KEEP(i, depth, id, is_cut_out)                                                 \
  {                                                                                          \
    const uint64_t key = keyOf(depth, id);                                                   \
    if (depth > 0.0 && depth <= 1.0 && key > held[i] && !(isMasked(id) && is_cut_out)) {     \
      held[i] = key;                                                                         \
      changed |= 1u << i;                                                                    \
    }                                                                                        \
  }

// By weights of the corners on the screen. They sum to 1.
void keep(int i, vec3 w, Part part, Drawn d, InstanceRecord instance) {
  const float depth = depthOf(part.depth, w);
  HELIO_KEEP(i, depth, part.id, isCutOut(d, instance, w, part.per_w))
}

bool mayTouch(uint i, ivec3 first) {
  const ivec3 most = first + batch[i].reach;
  return (most.x | most.y | most.z) >= 0 && batch[i].nearest >= farthest;
}

void drawByTile(Part part, ivec3 first) {
  Drawn d;
  InstanceRecord instance;
  if (isMasked(part.id)) {
    d = drawnTriangle(part.id);
    instance = InstanceTable(frame.instances).items[d.slot];
  }
  [[unroll]] for (int i = 0; i < kBlock; ++i) {
    const ivec3 e = first + part.across * (i % kSide) + part.down * (i / kSide);
    if ((e.x | e.y | e.z) >= 0) keep(i, (vec3(e) * float(1 << kSubpixelBits) + part.low) / part.area, part, d, instance);
  }
}

// Few are: those that are very long, and in what the camera sees those that reach behind the eye.
void drawAlone(uint id, ivec2 block) {
  const Drawn d = drawnTriangle(id);
  const InstanceRecord instance = InstanceTable(frame.instances).items[d.slot];
  const vec4 clip[3] = vec4[](clipCorner(d, instance, 0u), clipCorner(d, instance, 1u), clipCorner(d, instance, 2u));
  Part part;
  part.id = id;
  ScreenTriangle t;
  if (placeOnScreen(clip, t)) {
    const LargeEdges edges = edgesAt(t, i64vec2(block));
    part.depth = t.depth;
    part.per_w = t.per_w;
    if (edges.area == 0.0) return;
    [[unroll]] for (int i = 0; i < kBlock; ++i) {
      const i64vec3 e = edges.at + edges.across * int64_t(i % kSide) + edges.down * int64_t(i / kSide);
      if (e.x >= 0 && e.y >= 0 && e.z >= 0) keep(i, vec3(e) / edges.area, part, d, instance);
    }
    return;
  }
  const CrossingTriangle crossing = crossingTriangle(clip);
  [[unroll]] for (int i = 0; i < kBlock; ++i) {
    vec3 w;
    float depth;
    if (!hasPixel(crossing, pixelOf(block, i), w, depth)) continue;
    HELIO_KEEP(i, depth, id, isCutOut(d, instance, w))
  }
}

void main() {
  const uint thread = gl_LocalInvocationIndex, group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
  if (group >= rasterCounts().counts.shares) return;
  const RasterShare share = shares().items[group];
  if (share.tile / tilesOfAVolume() != raster.cascade) return;
  const int at = int(share.tile % tilesOfAVolume()), across = tilesAcross().x;
  const ivec2 tile = ivec2(at % across, at / across) << int(kTileBits), block = tile + blockOf(thread);
  [[unroll]] for (int i = 0; i < kBlock; ++i) held[i] = load(pixelOf(block, i));
  findFarthest();

  uint all_changed = 0u;
  for (uint begin = 0u; begin < share.count; begin += kTileBatch) {
    const uint size = min(kTileBatch, share.count - begin);
    barrier();  // the last batch was drawn
    if (thread < size) batch[thread] = partOf(inOrder().items[share.first + begin + thread], tile);
    barrier();
    for (uint i = 0u; i < size; ++i) {
      changed = 0u;
      if (batch[i].way == kByTile) {
        const ivec2 moved = block - tile;
        const ivec3 first = batch[i].at + batch[i].across * moved.x + batch[i].down * moved.y;
        if (mayTouch(i, first)) drawByTile(batch[i], first);
      } else if (batch[i].way == kAlone) {
        drawAlone(batch[i].id, block);
      }
      all_changed |= changed;
      if (changed != 0u) findFarthest();
    }
  }
  [[unroll]] for (int i = 0; i < kBlock; ++i)
    if ((all_changed & 1u << i) != 0u) keepKey(pixelOf(block, i), held[i]);
}
