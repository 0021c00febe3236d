// Streets by cutting the world in two again and again, blocks from what is left, and what each block is for.
#include "scene/city_plan.h"

#include <algorithm>
#include <cmath>

#include "scene/random.h"

namespace helio::scene {
namespace {

/// Land between streets that may still be cut.
struct Region {
  Polygon outline;
  std::vector<Street> streets;  ///< one for each edge
};

/// The part of a region on the line's inner side, with `street` along the cut.
Region cut(const Region& region, const HalfPlane& line, const Street& street) {
  Region part;
  const size_t count = region.outline.size();
  for (size_t i = 0; i < count; ++i) {
    const glm::dvec2 a = region.outline[i], b = region.outline[(i + 1) % count];
    const double da = line.distance(a), db = line.distance(b);
    if (da > 0.0) {
      part.outline.push_back(a);
      part.streets.push_back(region.streets[i]);
    }
    if ((da > 0.0) == (db > 0.0)) continue;
    part.outline.push_back(a + (b - a) * (da / (da - db)));
    part.streets.push_back(da > 0.0 ? street : region.streets[i]);  // leaving: the cut begins; entering: edge i goes on
  }
  return part;
}

HalfPlane reversed(const HalfPlane& line) { return {-line.normal, -line.offset}; }

class Planner {
 public:
  Planner(const Site& site, const Palette& palette) : site_(site), palette_(palette), random_(hash64(site.seed, 10)) {}

  std::vector<Region> divide() {
    const double h = site_.half();
    Region world{{{-h, -h}, {h, -h}, {h, h}, {-h, h}}, std::vector<Street>(4)};
    // Four main roads turn around the market square like a pinwheel; the square is what they leave in the middle.
    const double turn = -0.03 + 0.05 * random_.uniform();
    std::vector<Region> open;
    for (int i = 0; i < 4; ++i) {
      const glm::dvec2 normal = unitVector(0.25 * i + turn);
      const HalfPlane line{normal,
                           glm::dot(normal, site_.town_centre) - site_.square_half * random_.uniform(0.92f, 1.12f)};
      open.push_back(cut(world, reversed(line), mainRoad()));
      world = cut(world, line, mainRoad());
    }
    done_.push_back(world);
    while (!open.empty()) {
      Region region = std::move(open.back());
      open.pop_back();
      Region left, right;
      if (divide(region, left, right)) {
        open.push_back(std::move(left));
        open.push_back(std::move(right));
      } else {
        done_.push_back(std::move(region));
      }
    }
    return std::move(done_);
  }

 private:
  Street mainRoad() const { return {3.8, 3.0, palette_.cobbles, 4}; }

  /// Whether any of the region is in the town.
  bool touchesTown(const Polygon& outline) const {
    if (site_.urbanity(centroid(outline)) > 0.0 || contains(outline, site_.town_centre)) return true;
    return std::any_of(outline.begin(), outline.end(), [&](const glm::dvec2& p) { return site_.urbanity(p) > 0.0; });
  }

  /// The side of a block that needs no further cut.
  double blockSide(const glm::dvec2& p, bool town) const {
    const double urbanity = site_.urbanity(p);
    if (town) return urbanity > 0.6 ? 58.0 : urbanity > 0.3 ? 64.0 : 74.0;
    return site_.woodland(p) > 0.0 ? 150.0 : 112.0;
  }

  Street streetFor(bool town, double region_area) const {
    if (town) {
      if (region_area > 420.0 * 420.0) return {3.6, 3.0, palette_.cobbles, 4};
      if (region_area > 130.0 * 130.0) return {2.8, 2.2, palette_.cobbles, 3};
      return {2.2, 1.5, palette_.cobbles, 2};
    }
    if (region_area > 420.0 * 420.0) return {2.6, 0.0, palette_.asphalt, 4};
    if (region_area > 190.0 * 190.0) return {1.4, 0.0, palette_.dirt, 1};
    return {};  // a hedge between fields, nothing in the woods
  }

  bool divide(const Region& region, Region& left, Region& right) {
    const double region_area = area(region.outline);
    const bool town = touchesTown(region.outline);
    const Rectangle box = orientedBounds(region.outline);
    const double wanted = blockSide(centroid(region.outline), town && region_area < 200.0 * 200.0);
    const double limit = town && region_area >= 200.0 * 200.0 ? 0.0 : 1.35 * wanted * wanted;
    if (region_area < limit || box.half.y * 2.0 < 0.62 * wanted) {
      if (box.half.x * 2.0 < 1.9 * wanted) return false;
    }
    for (int attempt = 0; attempt < 8; ++attempt) {
      const double along = (2.0 * random_.uniform() - 1.0) * 0.24;
      const glm::dvec2 bend = unitVector((2.0 * random_.uniform() - 1.0) * 0.03);
      const glm::dvec2 across = town ? aroundTown(box) : box.axis;
      const glm::dvec2 normal{across.x * bend.x - across.y * bend.y, across.x * bend.y + across.y * bend.x};
      const HalfPlane line{normal, glm::dot(normal, box.centre + box.axis * (along * box.half.x))};
      const Street street = streetFor(town, region_area);
      left = cut(region, line, street);
      right = cut(region, reversed(line), street);
      if (sound(left) && sound(right)) return true;
    }
    return false;
  }

  /// The normal of a cut across the box, leaning towards the town's rays and rings: streets that lead to the market,
  /// and streets that go around it.
  glm::dvec2 aroundTown(const Rectangle& box) const {
    const glm::dvec2 offset = box.centre - site_.town_centre;
    if (glm::length(offset) < 1.5 * site_.square_half) return box.axis;
    const glm::dvec2 ray = glm::normalize(offset), ring{-ray.y, ray.x};
    const double along_ray = glm::dot(ray, box.axis), along_ring = glm::dot(ring, box.axis);
    const glm::dvec2 lean = std::abs(along_ray) > std::abs(along_ring) ? ray * (along_ray < 0.0 ? -1.0 : 1.0)
                                                                       : ring * (along_ring < 0.0 ? -1.0 : 1.0);
    return glm::normalize(glm::mix(box.axis, lean, 0.55));
  }

  /// Wide enough in every direction to be of use.
  bool sound(const Region& region) const {
    if (region.outline.size() < 3) return false;
    for (size_t i = 0; i < region.outline.size(); ++i) {
      if (glm::distance(region.outline[i], region.outline[(i + 1) % region.outline.size()]) < 9.0) return false;
    }
    return orientedBounds(region.outline).half.y > 17.0;
  }

  const Site& site_;
  const Palette& palette_;
  Random random_;
  std::vector<Region> done_;
};

glm::dvec2 longestEdge(const Polygon& polygon) {
  glm::dvec2 longest(1.0, 0.0);
  double length = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    if (glm::length(edge) <= length) continue;
    length = glm::length(edge);
    longest = edge / length;
  }
  return longest;
}

Polygon disc(const glm::dvec2& centre, double radius, int sides) {
  Polygon polygon;
  for (int i = 0; i < sides; ++i) polygon.push_back(centre + radius * unitVector(static_cast<double>(i) / sides));
  return polygon;
}

Polygon strip(const glm::dvec2& centre, const glm::dvec2& axis, double half_width) {
  const auto corners = Rectangle{centre, axis, {1000.0, half_width}}.corners();
  return {corners.begin(), corners.end()};
}

/// Paints the inside of a block's lot according to its use.
void paint(Block& block, const Palette& palette) {
  Random random(hash64(block.seed, 20));
  const glm::dvec2 axis = longestEdge(block.lot), middle = centroid(block.lot);
  const glm::dvec2 across{-axis.y, axis.x};
  switch (block.use) {
    case Use::square:
      block.zones.push_back({disc(middle, 8.0, 24), palette.cobbles, axis});
      block.zones.push_back({block.lot, palette.market, axis});
      break;
    case Use::homes:
      block.zones.push_back(
          {block.lot, block.quarter == Quarter::centre ? palette.courtyard : palette.lawn[random.below(3)], axis});
      break;
    case Use::park: {
      const std::vector<HalfPlane> lot = halfPlanes(block.lot);
      const glm::dvec2 diagonal = unitVector(0.06 + 0.1 * random.uniform());
      const glm::dvec2 path{axis.x * diagonal.x - axis.y * diagonal.y, axis.x * diagonal.y + axis.y * diagonal.x};
      block.zones.push_back({disc(middle, 5.5, 16), palette.gravel, axis});
      block.zones.push_back({clip(strip(middle, path, 1.3), lot), palette.gravel, path});
      block.zones.push_back({clip(strip(middle, {-path.y, path.x}, 1.3), lot), palette.gravel, path});
      block.zones.push_back({block.lot, palette.lawn[2], axis});
      break;
    }
    case Use::field: {
      // Parallel strips, each with its crop; a margin of grass remains around them.
      const glm::dvec2 rows = random.chance(0.5f) ? axis : across;
      const glm::dvec2 side{-rows.y, rows.x};
      const Polygon field = inset(block.lot, 2.5);
      if (field.empty()) break;
      Box2 reach;
      for (const glm::dvec2& p : field) reach.grow({glm::dot(p, side), 0.0});
      const int strips = 1 + static_cast<int>(random.below(4));
      const uint32_t first = random.below(3);
      for (int i = 0; i < strips; ++i) {
        const double width = (reach.max.x - reach.min.x) / strips, low = reach.min.x + width * i;
        const Polygon part = clip(field, {{side, low + (i > 0 ? 0.5 : 0.0)}, {-side, -(low + width)}});
        const uint32_t crop = (first + static_cast<uint32_t>(i) * (1 + random.below(2))) % 3;
        if (!part.empty()) block.zones.push_back({part, palette.crops[crop], rows});
      }
      block.zones.push_back({block.lot, block.pavement, axis});
      break;
    }
    case Use::orchard:
      block.zones.push_back({block.lot, palette.lawn[0], axis});
      break;
    case Use::meadow:
      block.zones.push_back({block.lot, palette.meadow[random.below(3)], axis});
      break;
    case Use::forest:
      block.zones.push_back({block.lot, palette.forest_floor, {1.0, 0.0}});
      break;
  }
}

Block makeBlock(const Site& site, const Palette& palette, const Region& region, uint64_t seed, bool market) {
  Block block;
  block.outline = region.outline;
  block.streets = region.streets;
  block.seed = seed;
  Random random(seed);
  const glm::dvec2 middle = centroid(region.outline);
  const double urbanity = site.urbanity(middle);
  if (market) {
    block.use = Use::square;
    block.quarter = Quarter::centre;
  } else if (urbanity > 0.0) {
    const bool near_market =
        glm::distance(middle, site.town_centre) < site.square_half + std::min(75.0, 0.42 * site.town_radius);
    block.quarter = urbanity > 0.66 || near_market ? Quarter::centre
                    : urbanity > 0.36              ? Quarter::town
                                                   : Quarter::suburb;
    block.use = !near_market && random.chance(0.09f) ? Use::park : Use::homes;
  } else if (site.woodland(middle) > 0.0) {
    block.use = Use::forest;
  } else {
    const float pick = random.uniform();
    block.use = pick < 0.62f ? Use::field : pick < 0.78f ? Use::orchard : Use::meadow;
  }
  std::vector<double> to_kerb, to_lot;
  for (const Street& street : block.streets) {
    to_kerb.push_back(street.half_width);
    const double verge = block.builtUp()            ? std::max(street.pavement, 1.2)
                         : street.rank > 0          ? 1.0
                         : block.use == Use::forest ? 0.0
                                                    : 0.4;
    to_lot.push_back(street.half_width + (block.use == Use::square ? 0.6 : verge));
  }
  block.kerb = inset(block.outline, to_kerb);
  block.lot = inset(block.outline, to_lot);
  if (block.builtUp()) {
    block.raise = 0.12f;
    block.kerb = chamfer(block.kerb, 1.4);
  }
  block.pavement = block.use == Use::square   ? palette.slabs
                   : block.builtUp()          ? palette.slabs
                   : block.use == Use::forest ? palette.meadow[1]
                                              : palette.meadow[seed % 3];
  paint(block, palette);
  return block;
}

}  // namespace

const Street& Block::streetAlong(const glm::dvec2& a, const glm::dvec2& b) const {
  size_t best = 0;
  double best_match = -2.0;
  for (size_t i = 0; i < outline.size(); ++i) {
    const double match =
        glm::dot(glm::normalize(b - a), glm::normalize(outline[(i + 1) % outline.size()] - outline[i]));
    if (match > best_match) {
      best_match = match;
      best = i;
    }
  }
  return streets[best];
}

CityPlan planCity(const CityParameters& parameters, const Palette& palette) {
  const Site site(parameters);
  CityPlan plan{site, HeightField(site), {}, 0};
  const std::vector<Region> regions = Planner(site, palette).divide();
  for (size_t i = 0; i < regions.size(); ++i) {
    plan.blocks.push_back(makeBlock(site, palette, regions[i], hash64(hash64(site.seed, 11), i), i == 0));
  }
  return plan;
}

}  // namespace helio::scene
