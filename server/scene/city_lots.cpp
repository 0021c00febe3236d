#include "scene/city_lots.h"

#include <algorithm>
#include <cmath>

namespace helio::scene {
namespace {

/// Two directions of an edge a -> b of a counter-clockwise polygon.
struct EdgeFrame {
  glm::dvec2 a, along, outward;
  double length;
};
EdgeFrame edgeFrame(const Polygon& polygon, size_t edge) {
  const glm::dvec2 a = polygon[edge], b = polygon[(edge + 1) % polygon.size()];
  const glm::dvec2 along = glm::normalize(b - a);
  return {a, along, {along.y, -along.x}, glm::distance(a, b)};
}

}  // namespace

Stand standBuilding(const CityPlan& plan, const Catalogue& catalogue, const Block& block, uint32_t prefab,
                    const glm::dvec2& position, const glm::dvec2& front) {
  Stand s{prefab, position, 0.0, front, 1.0f};
  const Rectangle covered = footprint(s, catalogue.bounds(prefab));
  s.y = plan.ground.highest(covered) + static_cast<double>(block.raise) - 0.15;
  return s;
}

LotFiller::LotFiller(const CityPlan& plan, const Catalogue& catalogue, const Block& block)
    : plan_(plan), catalogue_(catalogue), block_(block), random_(hash64(block.seed, 30)) {}

void LotFiller::reserve(const Stand& stand) {
  buildings_.push_back(footprint(stand, catalogue_.bounds(stand.prefab)));
  fixed.push_back(stand);
}

bool LotFiller::taken(const glm::dvec2& p, double radius) const {
  const auto near_building = [&](const Rectangle& r) { return distance(r, p) < radius; };
  const auto near_spot = [&](const Spot& s) { return glm::distance(s.p, p) < radius + s.radius; };
  return std::any_of(buildings_.begin(), buildings_.end(), near_building) ||
         std::any_of(spots_.begin(), spots_.end(), near_spot);
}

bool LotFiller::onPath(const glm::dvec2& p) const {
  return std::any_of(block_.zones.begin(), block_.zones.end(), [&](const Zone& zone) {
    return zone.surface == catalogue_.palette.gravel && contains(zone.polygon, p, -1.0);
  });
}

bool LotFiller::stand(uint32_t prefab, const glm::dvec2& p, const glm::dvec2& front, double clearance, bool is_fixed,
                      float scale) {
  if (taken(p, clearance)) return false;
  const Stand s{prefab, p, level(p), front, scale};
  if (is_fixed) fixed.push_back(s);
  else optional.push_back({hash64(block_.seed, optional.size()), s});
  spots_.push_back({p, clearance});
  return true;
}

uint32_t LotFiller::chooseHouse(Quarter quarter) {
  float total = 0.0f;
  for (const HouseEntry& h : catalogue_.houses) total += h.quarter == quarter ? h.weight : 0.0f;
  float pick = random_.uniform() * total;
  uint32_t chosen = catalogue_.houses.front().prefab;
  for (const HouseEntry& h : catalogue_.houses) {
    if (h.quarter != quarter) continue;
    chosen = h.prefab;
    pick -= h.weight;
    if (pick < 0.0f) break;
  }
  return chosen;
}

uint32_t LotFiller::chooseTree(bool garden) {
  float total = 0.0f;
  const auto fits = [&](const TreeEntry& t) { return garden ? t.garden : !t.conifer; };
  for (const TreeEntry& t : catalogue_.trees) total += fits(t) ? t.weight : 0.0f;
  float pick = random_.uniform() * total;
  uint32_t chosen = catalogue_.trees.front().prefab;
  for (const TreeEntry& t : catalogue_.trees) {
    if (!fits(t) || t.weight <= 0.0f) continue;
    chosen = t.prefab;
    pick -= t.weight;
    if (pick < 0.0f) break;
  }
  return chosen;
}

void LotFiller::fill(const glm::dvec2& keep_clear) {
  if (block_.lot.size() < 3) return;
  switch (block_.use) {
    case Use::square:
      square(keep_clear);
      break;
    case Use::homes:
      homes();
      break;
    case Use::park:
      park();
      break;
    case Use::field:
      field();
      break;
    case Use::orchard:
      orchard();
      break;
    case Use::meadow:
      meadow();
      break;
    case Use::forest:
      break;  // the woods are planted last, for the whole city
  }
}

// ---- Built-up blocks -----------------------------------------------------------------------------------------------

void LotFiller::homes() {
  // The best street first: it gets its row from corner to corner.
  std::vector<size_t> edges;
  for (size_t i = 0; i < block_.lot.size(); ++i) edges.push_back(i);
  const auto rank = [&](size_t i) {
    return block_.streetAlong(block_.lot[i], block_.lot[(i + 1) % block_.lot.size()]).rank;
  };
  std::stable_sort(edges.begin(), edges.end(), [&](size_t l, size_t r) { return rank(l) > rank(r); });
  for (size_t edge : edges) row(edge);
  streetFurniture();
  gardens();
}

void LotFiller::row(size_t edge) {
  const EdgeFrame e = edgeFrame(block_.lot, edge);
  const bool suburb = block_.quarter == Quarter::suburb;
  const double setback = suburb                            ? 2.5 + 2.5 * random_.uniform()
                         : block_.quarter == Quarter::town ? 0.8 * random_.uniform()
                                                           : 0.0;
  double t = suburb ? 2.0 : 0.0;
  while (t < e.length - 5.0) {
    if (!placeHouse(e.a, e.along, t, e.length, setback)) t += 1.0;
  }
}

bool LotFiller::placeHouse(const glm::dvec2& a, const glm::dvec2& along, double& t, double length, double setback) {
  const glm::dvec2 outward{along.y, -along.x};
  for (int attempt = 0; attempt < 5; ++attempt) {
    const uint32_t prefab = chooseHouse(block_.quarter);
    const Aabb& box = catalogue_.bounds(prefab);
    const double width = static_cast<double>(box.extent().x);
    if (t + width > length) continue;
    const double front_wall = static_cast<double>(box.max.z) - 0.6;  // steps and awnings reach over the pavement
    const glm::dvec2 centre = a + along * (t - static_cast<double>(box.min.x)) - outward * (setback + front_wall);
    const Stand s = standBuilding(plan_, catalogue_, block_, prefab, centre, outward);
    const Rectangle covered = footprint(s, box);
    Rectangle walls = covered;
    walls.half -= glm::dvec2(0.1, 0.35);
    walls.centre -= outward * 0.35;
    if (!inside(walls, block_.lot)) continue;
    if (std::any_of(buildings_.begin(), buildings_.end(), [&](const Rectangle& r) { return overlap(r, covered); }))
      continue;
    buildings_.push_back(covered);
    fixed.push_back(s);
    const double gap = block_.quarter == Quarter::centre ? 0.12
                       : block_.quarter == Quarter::town ? (random_.chance(0.6f) ? 0.2 : random_.uniform(2.5f, 5.0f))
                                                         : random_.uniform(4.0f, 9.0f);
    t += width + gap;
    return true;
  }
  return false;
}

void LotFiller::streetFurniture() {
  for (size_t i = 0; i < block_.kerb.size(); ++i) {
    const EdgeFrame e = edgeFrame(block_.kerb, i);
    if (e.length < 12.0) continue;
    const Street& street = block_.streetAlong(e.a, e.a + e.along);
    if (street.rank < 2) continue;
    const bool avenue = street.rank == 4;
    const double spacing = avenue ? 10.0 : street.rank == 3 ? 14.0 : 21.0;
    const int steps = static_cast<int>(e.length / spacing);
    const double first = 0.5 * (e.length - spacing * steps) + 0.25 * spacing;
    for (int k = 0; k <= steps; ++k) {
      const double t = first + spacing * k;
      if (t > e.length - 2.0) break;
      const bool lamp = k % 2 == 0;
      const glm::dvec2 p = e.a + e.along * t - e.outward * (lamp ? 0.5 : 0.9);
      if (lamp) stand(catalogue_.lantern, p, e.outward, 0.3, true);
      else if (avenue) stand(catalogue_.trees[3].prefab, p, anyDirection(), 1.0, true, random_.uniform(0.85f, 1.1f));
      else if (street.rank == 3 && random_.chance(0.5f)) stand(catalogue_.planter, p, e.outward, 0.5, false, 0.8f);
    }
    // Against the house fronts: benches, barrels, crates.
    if (street.pavement < 2.0) continue;
    for (double t = 4.0; t < e.length - 4.0; t += 7.0) {
      if (!random_.chance(0.3f)) continue;
      const uint32_t thing = random_.chance(0.4f)   ? catalogue_.bench
                             : random_.chance(0.5f) ? catalogue_.barrel
                                                    : catalogue_.crates;
      const glm::dvec2 p = e.a + e.along * (t + random_.uniform(0.0f, 3.0f)) - e.outward * (street.pavement - 0.75);
      stand(thing, p, e.outward, 0.5, false);
    }
  }
}

void LotFiller::gardens() {
  const bool suburb = block_.quarter == Quarter::suburb;
  if (suburb)
    boundary(random_.chance(0.6f)   ? catalogue_.hedge
             : random_.chance(0.5f) ? catalogue_.fence
                                    : catalogue_.stone_wall,
             0.5, 0.92);
  const Box2 box = bounds(block_.lot);
  const double density = block_.quarter == Quarter::centre ? 1.0 / 110.0 : 1.0 / 38.0;
  const int wishes = static_cast<int>(area(block_.lot) * density);
  for (int i = 0; i < wishes; ++i) {
    const glm::dvec2 p{glm::mix(box.min.x, box.max.x, static_cast<double>(random_.uniform())),
                       glm::mix(box.min.y, box.max.y, static_cast<double>(random_.uniform()))};
    if (!contains(block_.lot, p, 2.2)) continue;
    const float pick = random_.uniform();
    if (pick < 0.72f) stand(chooseTree(true), p, anyDirection(), 2.0, false, random_.uniform(0.7f, 1.05f));
    else if (pick < 0.92f) stand(catalogue_.bush, p, anyDirection(), 1.1, false, random_.uniform(0.8f, 1.3f));
    else if (pick < 0.95f) stand(catalogue_.well, p, anyDirection(), 1.6, false);
    else stand(catalogue_.crates, p, anyDirection(), 1.0, false);
  }
}

/// Lengths of hedge or fence around the lot, with gates in front of the houses.
void LotFiller::boundary(uint32_t prefab, double inset_distance, double share) {
  constexpr double kLength = 3.0;
  const Polygon line = inset(block_.lot, inset_distance);
  for (size_t i = 0; i < line.size(); ++i) {
    const EdgeFrame e = edgeFrame(line, i);
    const int pieces = static_cast<int>((e.length - 1.0) / kLength);
    const double first = 0.5 * (e.length - kLength * pieces);
    for (int k = 0; k < pieces; ++k) {
      const glm::dvec2 p = e.a + e.along * (first + kLength * (k + 0.5));
      const Rectangle piece{p, e.along, {1.5, 0.5}};
      const bool blocked = std::any_of(buildings_.begin(), buildings_.end(), [&](const Rectangle& house) {
        const bool gate = std::abs(glm::dot(house.centre - p, e.along)) < 1.6 && glm::distance(house.centre, p) < 14.0;
        return gate || overlap(house, piece);
      });
      if (blocked || onPath(p) || !random_.chance(static_cast<float>(share))) continue;
      optional.push_back({hash64(block_.seed, optional.size()), {prefab, p, level(p), e.outward, 1.0f}});
    }
  }
}

void LotFiller::square(const glm::dvec2& keep_clear) {
  const glm::dvec2 middle = centroid(block_.lot);
  stand(catalogue_.fountain, middle, {0.0, 1.0}, 5.5, true);
  const auto clear = [&](const glm::dvec2& p) { return glm::distance(p, keep_clear) > 12.0; };
  // Benches and lamps around the fountain.
  for (int i = 0; i < 8; ++i) {
    const glm::dvec2 d = unitVector((i + 0.5) / 8.0);
    if (i % 2 == 0) stand(catalogue_.bench, middle + d * 7.2, d, 0.8, true);
    else stand(catalogue_.globe_lamp, middle + d * 7.4, d, 0.4, true);
  }
  // Stalls in two rows along the longest sides, each with its goods beside it.
  const Rectangle box = orientedBounds(block_.lot);
  const glm::dvec2 across{-box.axis.y, box.axis.x};
  for (int side : {-1, 1}) {
    const int stalls = static_cast<int>((2.0 * box.half.x - 12.0) / 5.2);
    for (int k = 0; k < stalls; ++k) {
      const double x = 5.2 * (k - 0.5 * (stalls - 1));
      const glm::dvec2 p = middle + box.axis * x + across * (side * (box.half.y * 0.58));
      if (!clear(p) || !contains(block_.lot, p, 3.0) || random_.chance(0.15f)) continue;
      const uint32_t stall = catalogue_.stalls[random_.below(static_cast<uint32_t>(catalogue_.stalls.size()))];
      if (!stand(stall, p, -across * static_cast<double>(side), 1.9, true)) continue;
      const glm::dvec2 beside = p + box.axis * 2.6;
      stand(random_.chance(0.5f) ? catalogue_.barrel : catalogue_.crates, beside, anyDirection(), 0.45, false);
    }
  }
  stand(catalogue_.cart, middle + box.axis * (box.half.x * 0.55) + across * 2.0, anyDirection(), 1.6, true);
  stand(catalogue_.statue, middle - box.axis * (box.half.x * 0.62), -box.axis, 1.8, true);
  // Lindens and lamps along the edge.
  const Polygon edge = inset(block_.lot, 2.2);
  for (size_t i = 0; i < edge.size(); ++i) {
    const EdgeFrame e = edgeFrame(edge, i);
    const int steps = static_cast<int>(e.length / 7.0);
    for (int k = 0; k < steps; ++k) {
      const glm::dvec2 p = e.a + e.along * (7.0 * (k + 0.5) + 0.5 * (e.length - 7.0 * steps));
      if (!clear(p)) continue;
      if (k % 2 == 1) stand(catalogue_.trees[3].prefab, p, anyDirection(), 1.2, true, random_.uniform(0.9f, 1.05f));
      else stand(k % 4 == 0 ? catalogue_.lantern : catalogue_.planter, p, e.outward, 0.6, true);
    }
  }
}

void LotFiller::park() {
  const glm::dvec2 middle = centroid(block_.lot);
  stand(random_.chance(0.5f) ? catalogue_.statue : catalogue_.fountain, middle, anyDirection(), 3.0, true);
  for (int i = 0; i < 6; ++i) {
    const glm::dvec2 d = unitVector((i + 0.5) / 6.0);
    stand(i % 2 == 0 ? catalogue_.bench : catalogue_.globe_lamp, middle + d * 6.0, i % 2 == 0 ? -d : d, 0.5, true);
  }
  streetFurniture();
  boundary(catalogue_.hedge, 0.6, 0.95);
  const Box2 box = bounds(block_.lot);
  const int wishes = static_cast<int>(area(block_.lot) / 22.0);
  for (int i = 0; i < wishes; ++i) {
    const glm::dvec2 p{glm::mix(box.min.x, box.max.x, static_cast<double>(random_.uniform())),
                       glm::mix(box.min.y, box.max.y, static_cast<double>(random_.uniform()))};
    if (!contains(block_.lot, p, 3.0) || onPath(p)) continue;
    if (random_.chance(0.75f))
      stand(chooseTree(random_.chance(0.6f)), p, anyDirection(), 2.4, false, random_.uniform(0.8f, 1.1f));
    else stand(catalogue_.bush, p, anyDirection(), 1.2, false, random_.uniform(0.8f, 1.3f));
  }
}

// ---- Country -------------------------------------------------------------------------------------------------------

void LotFiller::field() {
  if (random_.chance(0.22f)) farmstead();
  hedgerow();
  for (const Zone& zone : block_.zones) {
    if (zone.surface != catalogue_.palette.crops[2]) continue;
    const Box2 box = bounds(zone.polygon);
    for (int i = 0; i < 8; ++i) {
      const glm::dvec2 p{glm::mix(box.min.x, box.max.x, static_cast<double>(random_.uniform())),
                         glm::mix(box.min.y, box.max.y, static_cast<double>(random_.uniform()))};
      if (contains(zone.polygon, p, 3.0))
        stand(catalogue_.hay_bale, p, anyDirection(), 2.5, false, random_.uniform(0.8f, 1.1f));
    }
  }
}

/// A farmhouse and a barn near the best road, with a few trees.
void LotFiller::farmstead() {
  for (size_t i = 0; i < block_.lot.size(); ++i) {
    const EdgeFrame e = edgeFrame(block_.lot, i);
    if (e.length < 50.0) continue;
    double t = 8.0 + 10.0 * random_.uniform();
    std::vector<Stand> group;
    for (int k = 0; k < 2; ++k) {
      const uint32_t prefab =
          catalogue_.houses[k == 0 ? catalogue_.houses.size() - 5 : catalogue_.houses.size() - 4 + random_.below(2)]
              .prefab;
      const Aabb& box = catalogue_.bounds(prefab);
      const glm::dvec2 p =
          e.a + e.along * (t - static_cast<double>(box.min.x)) - e.outward * (5.0 + static_cast<double>(box.max.z));
      const Stand s = standBuilding(plan_, catalogue_, block_, prefab, p, e.outward);
      if (!inside(footprint(s, box), block_.lot)) return;
      group.push_back(s);
      t += static_cast<double>(box.extent().x) + 6.0;
    }
    for (const Stand& s : group) reserve(s);
    const glm::dvec2 yard = e.a + e.along * (t + 2.0) - e.outward * 8.0;
    stand(catalogue_.cart, yard, anyDirection(), 1.6, false);
    stand(catalogue_.well, e.a + e.along * 3.0 - e.outward * 7.0, anyDirection(), 1.4, false);
    for (int k = 0; k < 5; ++k) {
      const glm::dvec2 p = e.a + e.along * (t * static_cast<double>(random_.uniform())) -
                           e.outward * static_cast<double>(random_.uniform(18.0f, 24.0f));
      if (contains(block_.lot, p, 2.0)) stand(chooseTree(true), p, anyDirection(), 2.4, false);
    }
    return;
  }
}

/// Poplars along main roads, bushes and old trees along lanes and between fields.
void LotFiller::hedgerow() {
  for (size_t i = 0; i < block_.lot.size(); ++i) {
    const EdgeFrame e = edgeFrame(block_.lot, i);
    const Street& street = block_.streetAlong(e.a, e.a + e.along);
    const double spacing = street.rank == 4 ? 10.0 : 7.0;
    const uint32_t poplar = catalogue_.trees[catalogue_.trees.size() - 2].prefab;
    for (double t = 3.0; t < e.length - 3.0; t += spacing) {
      const glm::dvec2 p = e.a + e.along * t - e.outward * 0.9;
      if (street.rank == 4) stand(poplar, p, anyDirection(), 1.5, false, random_.uniform(0.85f, 1.1f));
      else if (random_.chance(0.30f))
        stand(chooseTree(random_.chance(0.5f)), p, anyDirection(), 1.8, false, random_.uniform(0.7f, 1.0f));
      else if (random_.chance(0.5f)) stand(catalogue_.bush, p, anyDirection(), 1.0, false, random_.uniform(0.9f, 1.6f));
    }
  }
}

void LotFiller::orchard() {
  const Rectangle box = orientedBounds(block_.lot);
  const glm::dvec2 across{-box.axis.y, box.axis.x};
  const uint32_t apple = catalogue_.trees[8].prefab;
  for (double y = -box.half.y + 4.0; y < box.half.y - 3.0; y += 6.5) {
    for (double x = -box.half.x + 4.0; x < box.half.x - 3.0; x += 6.0) {
      const glm::dvec2 p = box.centre + box.axis * x + across * y +
                           glm::dvec2(random_.uniform(-0.5f, 0.5f), random_.uniform(-0.5f, 0.5f));
      if (contains(block_.lot, p, 3.0)) stand(apple, p, anyDirection(), 1.6, false, random_.uniform(0.8f, 1.15f));
    }
  }
  boundary(catalogue_.fence, 0.6, 0.9);
}

void LotFiller::meadow() {
  hedgerow();
  const Box2 box = bounds(block_.lot);
  const int wishes = static_cast<int>(area(block_.lot) / 260.0);
  for (int i = 0; i < wishes; ++i) {
    const glm::dvec2 p{glm::mix(box.min.x, box.max.x, static_cast<double>(random_.uniform())),
                       glm::mix(box.min.y, box.max.y, static_cast<double>(random_.uniform()))};
    if (!contains(block_.lot, p, 4.0)) continue;
    stand(random_.chance(0.7f) ? chooseTree(random_.chance(0.3f)) : catalogue_.bush, p, anyDirection(), 3.0, false,
          random_.uniform(0.8f, 1.2f));
  }
}

}  // namespace helio::scene
