// Terrain meshes. Each lattice triangle is cut exactly along kerbs, pavements, paths and fields, so that the painted
// plan has sharp edges at any distance; neighbouring pieces share their vertices, so that no light leaks between them.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <thread>
#include <tuple>
#include <unordered_map>

#include "scene/city_plan.h"
#include "scene/levels_of_detail.h"
#include "scene/mesh_builder.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

constexpr double kWeld = 1e-3;  // metres: points nearer than this are one, and so are points and edges
constexpr int kCells = static_cast<int>(kTile / kLattice);

/// A convex piece of ground with one paint.
struct Piece {
  Polygon polygon;
  uint32_t surface;
  glm::dvec2 axis;
  float raise;
};

/// A piece of kerb face: the raised side is on the left.
struct KerbFace {
  glm::dvec2 a, b;
  glm::dvec2 inside;  ///< a point in the same lattice square
  float raise;
};

/// All distinct points of a tile, found by cell.
class PointSet {
 public:
  explicit PointSet(glm::dvec2 origin) : origin_(origin) {}

  uint32_t weld(const glm::dvec2& p) {
    const uint32_t found = find(p);
    if (found != kNone) return found;
    const auto index = static_cast<uint32_t>(points_.size());
    points_.push_back(p);
    // Into every cell that the point touches: lookups then need one cell only.
    const glm::ivec2 low = cell(p - kWeld * 2.0), high = cell(p + kWeld * 2.0);
    for (int z = low.y; z <= high.y; ++z) {
      for (int x = low.x; x <= high.x; ++x) cells_[key({x, z})].push_back(index);
    }
    return index;
  }
  const glm::dvec2& operator[](uint32_t index) const { return points_[index]; }

  /// Points strictly between a and b on their line, in order. Both lie in the cell of `inside`.
  std::vector<uint32_t> between(uint32_t a, uint32_t b, const glm::dvec2& inside) const {
    const glm::dvec2 from = points_[a], edge = points_[b] - from;
    const double length = glm::length(edge);
    std::vector<std::pair<double, uint32_t>> found;
    const auto entry = cells_.find(key(cell(inside)));
    if (entry == cells_.end() || length < kWeld) return {};
    const glm::dvec2 along = edge / length;
    for (uint32_t i : entry->second) {
      const glm::dvec2 offset = points_[i] - from;
      const double t = glm::dot(offset, along), off = std::abs(offset.x * along.y - offset.y * along.x);
      if (i != a && i != b && off < kWeld && t > kWeld && t < length - kWeld) found.push_back({t, i});
    }
    std::sort(found.begin(), found.end());
    std::vector<uint32_t> indices;
    indices.reserve(found.size());
    for (const auto& [t, i] : found) indices.push_back(i);
    return indices;
  }

 private:
  glm::ivec2 cell(const glm::dvec2& p) const { return glm::ivec2(glm::floor((p - origin_) / kLattice)); }
  static int64_t key(const glm::ivec2& c) { return (int64_t{c.y} + 16) * 64 + c.x + 16; }
  uint32_t find(const glm::dvec2& p) const {
    const auto entry = cells_.find(key(cell(p)));
    if (entry == cells_.end()) return kNone;
    for (uint32_t i : entry->second) {
      if (glm::distance(points_[i], p) < kWeld) return i;
    }
    return kNone;
  }

  glm::dvec2 origin_;
  std::vector<glm::dvec2> points_;
  std::unordered_map<int64_t, std::vector<uint32_t>> cells_;
};

/// A piece's corners with every point that lies on its edges. Where the walk turns back on itself (the piece is thinner
/// there than kWeld), that part is left out: the neighbours' walks take the same points and close the gap. May come
/// back with fewer than three points: nothing is left.
std::vector<uint32_t> walkAround(const std::vector<uint32_t>& corners, const PointSet& points,
                                 const glm::dvec2& inside) {
  std::vector<uint32_t> ring;
  for (size_t k = 0; k < corners.size(); ++k) {
    ring.push_back(corners[k]);
    const auto extra = points.between(corners[k], corners[(k + 1) % corners.size()], inside);
    ring.insert(ring.end(), extra.begin(), extra.end());
  }
  for (size_t i = 0; i < ring.size() && ring.size() >= 3;) {
    const size_t count = ring.size(), before = (i + count - 1) % count, after = (i + 1) % count;
    if (ring[before] != ring[after]) {
      ++i;
      continue;
    }
    // ... x, y, x ...: drop y and one x, then look again from the start.
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(std::max(i, after)));
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(std::min(i, after)));
    i = 0;
  }
  return ring;
}

/// The corner from which a fan covers a convex polygon with triangles that all have some area, or -1.
int fanCorner(const std::vector<uint32_t>& ring, const PointSet& points) {
  const size_t count = ring.size();
  for (size_t first = 0; first < count; ++first) {
    bool sound = true;
    for (size_t i = 1; i + 1 < count && sound; ++i) {
      const glm::dvec2 a = points[ring[first]], b = points[ring[(first + i) % count]],
                       c = points[ring[(first + i + 1) % count]];
      sound = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) >
              kWeld * std::max(glm::distance(a, b), glm::distance(b, c)) * 0.3;
    }
    if (sound) return static_cast<int>(first);
  }
  return -1;
}

/// A block made ready for cutting.
struct Cutter {
  const Block* block;
  Box2 box;
  std::vector<HalfPlane> outline, kerb;
  std::vector<size_t> kerb_order;  ///< wide streets first
  std::vector<std::vector<HalfPlane>> zones;

  explicit Cutter(const Block& b)
      : block(&b), box(bounds(b.outline)), outline(halfPlanes(b.outline)), kerb(halfPlanes(b.kerb)) {
    for (size_t i = 0; i < kerb.size(); ++i) kerb_order.push_back(i);
    std::stable_sort(kerb_order.begin(), kerb_order.end(),
                     [&](size_t l, size_t r) { return street(l).rank > street(r).rank; });
    for (const Zone& zone : b.zones) zones.push_back(halfPlanes(zone.polygon));
  }
  const Street& street(size_t kerb_edge) const {
    return block->streetAlong(block->kerb[kerb_edge], block->kerb[(kerb_edge + 1) % block->kerb.size()]);
  }
};

/// Whether some line has the whole polygon on its outer side: the quick answer for most pairs of triangle and block.
bool apart(const Polygon& polygon, const std::vector<HalfPlane>& planes) {
  return std::any_of(planes.begin(), planes.end(), [&](const HalfPlane& plane) {
    return std::all_of(polygon.begin(), polygon.end(), [&](const glm::dvec2& p) { return plane.distance(p) <= 0.0; });
  });
}

/// Cuts the part of `triangle` in one block into painted pieces.
void cutPieces(const Polygon& triangle, const Cutter& cutter, std::vector<Piece>& pieces,
               std::vector<KerbFace>& kerbs) {
  const Block& block = *cutter.block;
  if (apart(triangle, cutter.outline)) return;
  Polygon rest = clip(triangle, cutter.outline), inner, outer;
  if (rest.empty()) return;
  const auto emit = [&](const Polygon& polygon, uint32_t surface, const glm::dvec2& axis, float raise) {
    if (polygon.size() >= 3) pieces.push_back({polygon, surface, axis, raise});
  };

  // Streets: what lies outside the kerb.
  for (size_t edge : cutter.kerb_order) {
    split(rest, cutter.kerb[edge], inner, outer);
    const glm::dvec2 normal = cutter.kerb[edge].normal;
    if (!outer.empty()) emit(outer, cutter.street(edge).surface, {normal.y, -normal.x}, 0.0f);
    rest.swap(inner);
    if (rest.empty()) return;
  }
  if (block.raise > 0.0f) {
    for (size_t i = 0; i < rest.size(); ++i) {
      const glm::dvec2 a = rest[i], b = rest[(i + 1) % rest.size()];
      for (const HalfPlane& plane : cutter.kerb) {
        const bool on_kerb = std::abs(plane.distance(a)) < 1e-6 && std::abs(plane.distance(b)) < 1e-6;
        if (on_kerb && glm::distance(a, b) > kWeld) kerbs.push_back({a, b, centroid(triangle), block.raise});
      }
    }
  }

  // Zones in order, then pavement on what no zone covers.
  std::vector<Polygon> open{rest}, next;
  for (size_t z = 0; z < cutter.zones.size() && !open.empty(); ++z) {
    next.clear();
    for (Polygon& polygon : open) {
      for (const HalfPlane& plane : cutter.zones[z]) {
        split(polygon, plane, inner, outer);
        if (!outer.empty()) next.push_back(outer);
        polygon.swap(inner);
        if (polygon.empty()) break;
      }
      if (!polygon.empty()) emit(polygon, block.zones[z].surface, block.zones[z].axis, block.raise);
    }
    open.swap(next);
  }
  const glm::dvec2 edge = glm::normalize(block.outline[1] - block.outline[0]);
  for (const Polygon& polygon : open) emit(polygon, block.pavement, edge, block.raise);
}

/// Collects vertices and triangles of one tile by material.
class TileBuilder {
 public:
  TileBuilder(const CityPlan& plan, const Palette& palette, glm::dvec2 centre, const PointSet& points)
      : plan_(plan), palette_(palette), centre_(centre), points_(points) {}

  void add(const Piece& piece, const std::vector<uint32_t>& ring) {
    const uint64_t paint =
        hash64((uint64_t{piece.surface} << 32) ^ static_cast<uint64_t>(static_cast<int64_t>(piece.axis.x * 1e6) * 31) ^
               static_cast<uint64_t>(piece.raise * 1000.0f));
    std::vector<uint32_t>& indices = by_material_[piece.surface];
    std::vector<uint32_t> corners;
    corners.reserve(ring.size());
    for (uint32_t i : ring) corners.push_back(vertex(piece, points_[i], hash64(paint, i)));
    // (x, z) counter-clockwise is clockwise seen from above: triangles run the other way round.
    const size_t count = corners.size();
    const int first = fanCorner(ring, points_);
    if (first >= 0) {
      const auto at = [&](size_t i) { return corners[(static_cast<size_t>(first) + i) % count]; };
      for (size_t i = 1; i + 1 < count; ++i) indices.insert(indices.end(), {at(0), at(i + 1), at(i)});
      return;
    }
    Polygon outline;
    for (uint32_t i : ring) outline.push_back(points_[i]);
    const uint32_t middle = vertex(piece, centroid(outline), hash64(hash64(paint, ring[0]), ~uint64_t{ring[1]}));
    for (size_t i = 0; i < count; ++i) indices.insert(indices.end(), {middle, corners[(i + 1) % count], corners[i]});
  }

  void addKerb(const glm::dvec2& a, const glm::dvec2& b, float raise) {
    const glm::dvec2 along = glm::normalize(b - a);
    const glm::vec3 outward(along.y, 0.0f, -along.x);
    const auto corner = [&](const glm::dvec2& p, float lift) {
      mesh_.positions.push_back(position(p, lift));
      mesh_.normals.push_back(outward);
      mesh_.uvs.push_back({static_cast<float>(glm::dot(p - centre_, along)), -lift});
      return static_cast<uint32_t>(mesh_.positions.size() - 1);
    };
    const uint32_t a0 = corner(a, 0.0f), a1 = corner(a, raise), b0 = corner(b, 0.0f), b1 = corner(b, raise);
    std::vector<uint32_t>& indices = by_material_[palette_.kerb];
    indices.insert(indices.end(), {a0, a1, b1, a0, b1, b0});
  }

  Mesh build(std::string name) {
    mesh_.name = std::move(name);
    addSubmeshes(mesh_, by_material_);
    mesh_.finish();
    return std::move(mesh_);
  }

 private:
  glm::vec3 position(const glm::dvec2& p, float raise) const {
    const double y = plan_.ground.height(p) + static_cast<double>(raise);
    return glm::vec3(glm::dvec3(p.x - centre_.x, y, p.y - centre_.y));
  }
  uint32_t vertex(const Piece& piece, const glm::dvec2& p, uint64_t key) {
    const auto [entry, fresh] = vertices_.try_emplace(key, static_cast<uint32_t>(mesh_.positions.size()));
    if (fresh) {
      const glm::dvec2 side{-piece.axis.y, piece.axis.x}, metres = palette_.metres[piece.surface];
      const auto uv = [&](const glm::dvec2& q) {
        return glm::dvec2(glm::dot(q, piece.axis), glm::dot(q, side)) / metres;
      };
      mesh_.positions.push_back(position(p, piece.raise));
      mesh_.normals.push_back(plan_.ground.normal(p));
      mesh_.uvs.push_back(glm::vec2(uv(p) - glm::floor(uv(centre_))));  // whole repetitions off: small numbers, no seam
    }
    return entry->second;
  }

  const CityPlan& plan_;
  const Palette& palette_;
  glm::dvec2 centre_;
  const PointSet& points_;
  Mesh mesh_;
  std::map<uint32_t, std::vector<uint32_t>> by_material_;
  std::unordered_map<uint64_t, uint32_t> vertices_;
};

Mesh buildTile(const CityPlan& plan, const Palette& palette, const std::vector<const Cutter*>& cutters,
               glm::dvec2 origin, std::string name) {
  PointSet points(origin);
  struct Cell {
    std::vector<Piece> pieces;
    std::vector<std::vector<uint32_t>> rings;  // the pieces' corners as points
    std::vector<KerbFace> kerbs;
    bool own = false;  // in this tile, not across its border
  };
  std::vector<Cell> triangles;
  // Cut this tile's triangles and those just across its border, whose cuts put vertices on the border too.
  for (int z = -1; z <= kCells; ++z) {
    for (int x = -1; x <= kCells; ++x) {
      const glm::dvec2 a = origin + glm::dvec2(x, z) * kLattice, c = a + kLattice;
      const glm::dvec2 b{c.x, a.y}, d{a.x, c.y};
      for (const Polygon& triangle : {Polygon{a, b, c}, Polygon{a, c, d}}) {
        Cell cell;
        cell.own = x >= 0 && z >= 0 && x < kCells && z < kCells;
        const Box2 box = bounds(triangle);
        for (const Cutter* cutter : cutters) {
          if (cutter->box.overlaps(box)) cutPieces(triangle, *cutter, cell.pieces, cell.kerbs);
        }
        for (const Piece& piece : cell.pieces) {
          std::vector<uint32_t> ring;
          for (const glm::dvec2& p : piece.polygon) {
            const uint32_t i = points.weld(p);
            if (ring.empty() || (ring.back() != i && ring.front() != i)) ring.push_back(i);
          }
          cell.rings.push_back(std::move(ring));
        }
        if (!cell.pieces.empty()) triangles.push_back(std::move(cell));
      }
    }
  }
  TileBuilder builder(plan, palette, origin + 0.5 * kTile, points);
  for (const Cell& cell : triangles) {
    if (!cell.own) continue;
    for (size_t i = 0; i < cell.pieces.size(); ++i) {
      const std::vector<uint32_t> ring = walkAround(cell.rings[i], points, centroid(cell.pieces[i].polygon));
      if (ring.size() < 3) continue;
      builder.add(cell.pieces[i], ring);
    }
    for (const KerbFace& kerb : cell.kerbs) {
      std::vector<uint32_t> line{points.weld(kerb.a)};
      const uint32_t end = points.weld(kerb.b);
      const auto extra = points.between(line[0], end, kerb.inside);
      line.insert(line.end(), extra.begin(), extra.end());
      line.push_back(end);
      for (size_t i = 0; i + 1 < line.size(); ++i) builder.addKerb(points[line[i]], points[line[i + 1]], kerb.raise);
    }
  }
  return builder.build(std::move(name));
}

/// One side of the bare hills around the world: rows of the border's points, pushed further and further out.
Mesh buildApron(const CityPlan& plan, const Palette& palette, int side, std::string name) {
  constexpr int kRows = 24;
  const double half = plan.site.half();
  const auto columns = static_cast<int>(plan.site.side / kLattice);
  const glm::dvec2 along = unitVector(0.25 * side), outward{along.y, -along.x};
  const auto point = [&](int row, int column) {
    const double t = static_cast<double>(row) / kRows, scale = (half + plan.site.apron * t * std::sqrt(t)) / half;
    return scale * (along * (-half + kLattice * column) + outward * half);
  };
  Mesh mesh;
  mesh.name = std::move(name);
  std::map<uint32_t, std::vector<uint32_t>> by_material;
  std::map<std::tuple<uint32_t, int, int>, uint32_t> vertices;
  const auto vertex = [&](uint32_t material, int row, int column) {
    const auto [entry, fresh] =
        vertices.try_emplace({material, row, column}, static_cast<uint32_t>(mesh.positions.size()));
    if (fresh) {
      const glm::dvec2 p = point(row, column);
      mesh.positions.push_back(glm::vec3(glm::dvec3(p.x, plan.ground.height(p), p.y)));
      mesh.normals.push_back(plan.ground.normal(p));
      mesh.uvs.push_back(glm::vec2(p / glm::dvec2(palette.metres[material])));
    }
    by_material[material].push_back(entry->second);
  };
  using Corner = std::pair<int, int>;
  for (int row = 0; row < kRows; ++row) {
    for (int i = 0; i < columns; ++i) {
      const Corner a{row, i}, b{row, i + 1}, c{row + 1, i}, d{row + 1, i + 1};
      for (const auto& triangle : {std::array{a, b, c}, std::array{b, d, c}}) {
        glm::dvec2 middle(0.0);
        for (const Corner& corner : triangle) middle += point(corner.first, corner.second) / 3.0;
        const bool wooded = fractalNoise(hash64(plan.site.seed, 60), middle.x / 240.0, middle.y / 240.0, 3) > -0.05f;
        for (const Corner& corner : triangle)
          vertex(wooded ? palette.hill_woods : palette.hill, corner.first, corner.second);
      }
    }
  }
  addSubmeshes(mesh, by_material);
  mesh.finish();
  return mesh;
}

}  // namespace

Ground buildGround(const CityPlan& plan, const Palette& palette) {
  std::vector<Cutter> cutters;
  cutters.reserve(plan.blocks.size());
  for (const Block& block : plan.blocks) cutters.emplace_back(block);
  const auto tiles = static_cast<int64_t>(plan.site.side / kTile);
  std::vector<std::vector<const Cutter*>> by_tile(static_cast<size_t>(tiles * tiles));
  for (const Cutter& cutter : cutters) {
    // A tile also cuts the triangles around it: take its neighbourhood of one lattice square.
    const auto index = [&](double v) {
      return std::clamp<int64_t>(static_cast<int64_t>(std::floor((v + plan.site.half()) / kTile)), 0, tiles - 1);
    };
    for (int64_t z = index(cutter.box.min.y - kLattice); z <= index(cutter.box.max.y + kLattice); ++z) {
      for (int64_t x = index(cutter.box.min.x - kLattice); x <= index(cutter.box.max.x + kLattice); ++x) {
        by_tile[static_cast<size_t>(z * tiles + x)].push_back(&cutter);
      }
    }
  }
  // Tiles are independent of each other: every thread takes the next one, and the result does not depend on which.
  Ground ground;
  ground.meshes.resize(by_tile.size());
  ground.centres.resize(by_tile.size());
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i = next++; i < by_tile.size(); i = next++) {
      const int64_t x = static_cast<int64_t>(i) % tiles, z = static_cast<int64_t>(i) / tiles;
      const glm::dvec2 origin = glm::dvec2(x, z) * kTile - plan.site.half();
      const std::string name = "terrain_" + std::to_string(x) + "_" + std::to_string(z);
      ground.meshes[i] = buildTile(plan, palette, by_tile[i], origin, name);
      makeTileLevels(ground.meshes[i]);
      ground.centres[i] = origin + 0.5 * kTile;
    }
  };
  std::vector<std::thread> helpers(std::min<size_t>(std::max(1u, std::thread::hardware_concurrency()), 16) - 1);
  for (std::thread& helper : helpers) helper = std::thread(work);
  work();
  for (std::thread& helper : helpers) helper.join();
  for (int side = 0; side < 4; ++side) {
    ground.meshes.push_back(buildApron(plan, palette, side, "terrain_hills_" + std::to_string(side)));
    ground.centres.push_back(glm::dvec2(0.0));
  }
  return ground;
}

}  // namespace helio::scene
