#include "scene/city_furnish.h"

#include <algorithm>
#include <cmath>

#include "scene/city_lots.h"
#include "scene/random.h"

namespace helio::scene {

glm::mat4x3 Stand::transform() const {
  const glm::vec3 z(static_cast<float>(front.x), 0.0f, static_cast<float>(front.y)), x(z.z, 0.0f, -z.x);
  return {x * scale, glm::vec3(0.0f, scale, 0.0f), z * scale, glm::vec3(glm::dvec3(position.x, y, position.y))};
}

Rectangle footprint(const Stand& stand, const Aabb& bounds) {
  const glm::dvec2 right{stand.front.y, -stand.front.x};
  const glm::dvec3 centre(bounds.centre()), half(0.5f * bounds.extent());
  const auto scale = static_cast<double>(stand.scale);
  return {stand.position + (right * centre.x + stand.front * centre.z) * scale, right,
          glm::dvec2(half.x, half.z) * scale};
}

namespace {

/// A landmark and the block that it stands in.
struct LandmarkSite {
  size_t block;
  Stand stand;
};

/// The nearest place to the square, on a block's street side, where the building fits; each block takes one.
bool placeByTheSquare(const CityPlan& plan, const Catalogue& catalogue, uint32_t prefab,
                      std::vector<LandmarkSite>& placed) {
  const glm::dvec2 market = centroid(plan.blocks[plan.market].lot);
  const Aabb& box = catalogue.bounds(prefab);
  double best = 1e300;
  LandmarkSite choice{};
  for (size_t i = 0; i < plan.blocks.size(); ++i) {
    const Block& block = plan.blocks[i];
    if (block.use != Use::homes || glm::distance(centroid(block.outline), market) > plan.site.square_half + 120.0)
      continue;
    if (std::any_of(placed.begin(), placed.end(), [&](const LandmarkSite& s) { return s.block == i; })) continue;
    for (size_t edge = 0; edge < block.lot.size(); ++edge) {
      const glm::dvec2 a = block.lot[edge], b = block.lot[(edge + 1) % block.lot.size()];
      const glm::dvec2 along = glm::normalize(b - a), outward{along.y, -along.x};
      const double length = glm::distance(a, b), width = static_cast<double>(box.extent().x);
      for (double t = 0.5; t + width < length; t += 1.0) {
        const glm::dvec2 p =
            a + along * (t - static_cast<double>(box.min.x)) - outward * (static_cast<double>(box.max.z) + 0.3);
        const Stand stand = standBuilding(plan, catalogue, block, prefab, p, outward);
        if (!inside(footprint(stand, box), block.lot)) continue;
        const glm::dvec2 door = p + outward * static_cast<double>(box.max.z);
        // Near, and looking at the square.
        const double cost = glm::distance(door, market) * (1.6 - glm::dot(outward, glm::normalize(market - door)));
        if (cost >= best) continue;
        best = cost;
        choice = {i, stand};
      }
    }
  }
  if (best < 1e300) placed.push_back(choice);
  return best < 1e300;
}

/// Plants `count` trees in the woods: a jittered grid, as fine as it must be, thinned to the number at random.
void plantWoods(const CityPlan& plan, const Catalogue& catalogue, size_t count, std::vector<Stand>& stands) {
  if (count == 0) return;
  double woods = 0.0;
  for (const Block& block : plan.blocks) woods += block.use == Use::forest ? area(block.lot) : 0.0;
  const uint64_t seed = hash64(plan.site.seed, 40);
  std::vector<Wish> wishes;
  for (double spacing = 0.99 * std::sqrt(woods / static_cast<double>(count)); wishes.size() < count; spacing *= 0.93) {
    wishes.clear();
    for (const Block& block : plan.blocks) {
      if (block.use != Use::forest || block.lot.size() < 3) continue;
      const std::vector<HalfPlane> lot = halfPlanes(block.lot);
      const Box2 box = bounds(block.lot);
      for (auto iz = static_cast<int64_t>(std::floor(box.min.y / spacing));
           static_cast<double>(iz) * spacing < box.max.y; ++iz) {
        for (auto ix = static_cast<int64_t>(std::floor(box.min.x / spacing));
             static_cast<double>(ix) * spacing < box.max.x; ++ix) {
          const uint64_t h = hash64(seed, ix, iz);
          Random random(h);
          const glm::dvec2 p = glm::dvec2(ix, iz) * spacing +
                               spacing * glm::dvec2(random.uniform(0.1f, 0.9f), random.uniform(0.1f, 0.9f));
          if (std::any_of(lot.begin(), lot.end(), [&](const HalfPlane& h2) { return h2.distance(p) < 1.2; })) continue;
          // Stands of conifers and of broadleaves, with mixed borders.
          const float conifers =
              fractalNoise(hash64(seed, 1), p.x / 90.0, p.y / 90.0, 2) + 0.25f * (random.uniform() - 0.5f);
          const bool conifer = conifers > 0.05f;
          if (!conifer && random.chance(0.3f)) continue;  // broader crowns stand further apart
          const auto fits = [&](const TreeEntry& t) { return t.conifer == conifer; };
          float total = 0.0f;
          for (const TreeEntry& t : catalogue.trees) total += fits(t) ? t.weight : 0.0f;
          float pick = random.uniform() * total;
          uint32_t prefab = 0;
          for (const TreeEntry& t : catalogue.trees) {
            if (!fits(t) || t.weight <= 0.0f) continue;
            prefab = t.prefab;
            pick -= t.weight;
            if (pick < 0.0f) break;
          }
          const double ground = plan.ground.height(p) - 0.1;
          wishes.push_back({hash64(h), {prefab, p, ground, unitVector(random.uniform()), random.uniform(0.85f, 1.3f)}});
        }
      }
    }
  }
  std::sort(wishes.begin(), wishes.end(), [](const Wish& a, const Wish& b) { return a.priority < b.priority; });
  for (size_t i = 0; i < count; ++i) stands.push_back(wishes[i].stand);
}

}  // namespace

Furnishing furnish(const CityPlan& plan, const Catalogue& catalogue, size_t count, size_t mills, size_t fitted) {
  Furnishing result;
  std::vector<LandmarkSite> landmarks;
  for (uint32_t prefab : {catalogue.glass_hall, catalogue.town_hall, catalogue.church}) {
    placeByTheSquare(plan, catalogue, prefab, landmarks);
  }
  for (const LandmarkSite& s : landmarks) result.landmarks.push_back(s.stand);

  // The corner of the square from which the landmarks are best seen stays free for a camera.
  const Polygon& square = plan.blocks[plan.market].lot;
  const glm::dvec2 middle = centroid(square);
  double best = -1e300;
  for (const glm::dvec2& corner : square) {
    double view = 0.0;
    for (const Stand& s : result.landmarks)
      view += glm::dot(glm::normalize(middle - corner), glm::normalize(s.position - corner));
    if (view <= best) continue;
    best = view;
    result.town_view = corner + (middle - corner) * 0.12;
  }

  std::vector<Wish> optional;
  const double mill_distance = plan.site.town_radius * 1.12;
  size_t mill_block = plan.blocks.size();
  for (size_t i = 0; i < plan.blocks.size(); ++i) {
    if (plan.blocks[i].use != Use::field && plan.blocks[i].use != Use::meadow) continue;
    const auto off = [&](size_t k) {
      return std::abs(glm::distance(centroid(plan.blocks[k].lot), plan.site.town_centre) - mill_distance);
    };
    if (mill_block == plan.blocks.size() || off(i) < off(mill_block)) mill_block = i;
  }
  const auto farmed = static_cast<size_t>(std::count_if(plan.blocks.begin(), plan.blocks.end(), [](const Block& b) {
    return b.use == Use::field || b.use == Use::meadow;
  }));
  const uint64_t every = std::max<size_t>(1, farmed / (2 * std::max<size_t>(1, mills)));  // half of them are too small
  size_t farms = 0;
  std::vector<Stand> farmhouses;
  for (size_t i = 0; i < plan.blocks.size(); ++i) {
    const Block& block = plan.blocks[i];
    LotFiller filler(plan, catalogue, block);
    for (const LandmarkSite& s : landmarks) {
      if (s.block == i) filler.reserve(s.stand);
    }
    if (i == mill_block) {
      const glm::dvec2 p = centroid(block.lot);
      filler.reserve(
          standBuilding(plan, catalogue, block, catalogue.windmill, p, glm::normalize(plan.site.town_centre - p)));
    }
    const Use use = block.use;
    if (i != mill_block && (use == Use::field || use == Use::meadow) && block.lot.size() >= 3 &&
        result.animated.size() < mills && hash64(block.seed, 61) % every == 0) {
      const glm::dvec2 p = centroid(block.lot);
      const Stand mill = standBuilding(plan, catalogue, block, catalogue.turning_mill, p, unitVector(0.1));
      if (inside(footprint(mill, catalogue.bounds(catalogue.windmill)), block.lot)) {
        filler.reserve(mill);
        result.animated.push_back(mill);
        filler.fixed.pop_back();
      }
    }
    filler.fill(result.town_view);
    for (Stand stand : filler.fixed) {
      const uint32_t follows = catalogue.fittedTo(stand.prefab);
      if (follows == kNone || farms == fitted) {
        result.stands.push_back(stand);
        continue;
      }
      ++farms;
      stand.prefab = follows;
      farmhouses.push_back(stand);
    }
    optional.insert(optional.end(), filler.optional.begin(), filler.optional.end());
  }

  result.animated.insert(result.animated.end(), farmhouses.begin(), farmhouses.end());

  // The woods get at least a quarter of all instances; gardens and hedgerows give way when they would not.
  const size_t fixed = std::min(result.stands.size(), count);
  result.stands.resize(fixed);
  const size_t room = count - fixed, most = room - std::min(room, count / 4);
  if (optional.size() > most) {
    std::sort(optional.begin(), optional.end(), [](const Wish& a, const Wish& b) { return a.priority < b.priority; });
    optional.resize(most);
  }
  for (const Wish& wish : optional) result.stands.push_back(wish.stand);
  plantWoods(plan, catalogue, count - result.stands.size(), result.stands);
  return result;
}

}  // namespace helio::scene
