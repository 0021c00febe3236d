// The house catalogue: a table of designs, and one builder that follows a design.
#include "scene/catalogue.h"
#include "scene/house_parts.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

enum class Roof { gable, gable_front, hip, mansard, flat };
enum class Front { door, shop, gate };  // what the ground floor shows to the street

struct HouseDesign {
  Quarter quarter;
  float weight;
  int bays, depth;  ///< window axes along the street and away from it
  int storeys;
  Roof roof;
  float rise;  ///< metres from the eaves to the ridge
  uint32_t wall, ground_wall, roof_cover, trim;
  Front front = Front::door;
  int dormers = 0;  ///< on the street side
  int chimneys = 1;
  int wing = 0;        ///< bays of a gabled wing towards the back, 0 = none
  bool tower = false;  ///< a corner turret
  int lit = 0;         ///< windows with a light behind them
};

/// A box-shaped part of a house: walls, openings and roof.
class HouseBuilder {
 public:
  HouseBuilder(std::string name, const Palette& palette, const HouseDesign& design, uint64_t seed)
      : p_(palette), d_(design), b_(std::move(name), palette), seed_(seed) {}

  Mesh build() {
    const float width = static_cast<float>(d_.bays) * kBay, depth = static_cast<float>(d_.depth) * kBay;
    const float back_shift = d_.wing > 0 ? 0.5f * static_cast<float>(d_.wing) * kBay : 0.0f;
    body({0.0f, 0.0f, back_shift}, d_.bays, d_.depth, d_.storeys, true);
    centre_ = {0.0f, 0.0f, back_shift};
    roof(width, depth);
    if (d_.wing > 0) wing(width, depth, back_shift);
    if (d_.tower) tower(width, depth);
    return b_.build();
  }

 private:
  uint32_t glass() {
    const bool light = lit_ < d_.lit && hash64(seed_, ++windows_) % 4 == 0;
    lit_ += light;
    return light ? p_.lit_window : p_.window;
  }
  float eaves() const { return kPlinth + static_cast<float>(d_.storeys) * kStorey; }

  /// Four walls with their openings, on a plinth, centred at `centre`.
  void body(glm::vec3 centre, int bays, int depth, int storeys, bool main) {
    const float width = static_cast<float>(bays) * kBay, length = static_cast<float>(depth) * kBay;
    b_.setFrame(centre);
    plinth(b_, p_.ashlar[1], width, length);
    for (int side = 0; side < 4; ++side) {
      const bool across = side % 2 == 0;
      const float span = across ? width : length, out = 0.5f * (across ? length : width);
      const glm::vec3 outward = side == 0   ? glm::vec3(0, 0, 1)
                                : side == 1 ? glm::vec3(1, 0, 0)
                                : side == 2 ? glm::vec3(0, 0, -1)
                                            : glm::vec3(-1, 0, 0);
      const glm::vec3 right{outward.z, 0.0f, -outward.x};
      b_.setFrame(centre + outward * out - right * (0.5f * span) + glm::vec3(0.0f, kPlinth, 0.0f), side);
      for (int storey = 0; storey < storeys; ++storey) { facade(side, across ? bays : depth, storey, main); }
    }
    b_.setFrame(centre);
    if (main && d_.storeys > 2) stringCourse(b_, d_.trim, width, length, kPlinth + kStorey - 0.12f, 0.2f, 0.09f);
  }

  void facade(int side, int bays, int storey, bool main) {
    const float span = static_cast<float>(bays) * kBay;
    const float low = static_cast<float>(storey) * kStorey, high = low + kStorey;
    std::vector<Opening> openings;
    for (int bay = 0; bay < bays; ++bay) {
      const float x = (static_cast<float>(bay) + 0.5f) * kBay;
      if (side == 0 && main && storey == 0) groundFloor(openings, x, bay, bays);
      else if (hasWindow(side, bay, bays, storey))
        openings.push_back({x - 0.55f, x + 0.55f, low + 0.85f, low + 2.35f, glass()});
    }
    wallWithOpenings(b_, storey == 0 ? d_.ground_wall : d_.wall, 0.0f, span, low, high, openings);
    if (side == 0 && main && storey == 0) frontage(span, bays);
  }

  /// Fewer windows at the back, a few at the sides above the ground floor.
  bool hasWindow(int side, int bay, int bays, int storey) const {
    if (d_.front == Front::gate) return side == 0 && storey > 0 && bay % 2 == 1;
    if (side == 0) return true;
    if (side == 2) return bays < 3 || bay % 2 == 0;
    return d_.quarter == Quarter::centre ? false : bay == bays / 2 && (storey > 0 || d_.quarter != Quarter::town);
  }

  void groundFloor(std::vector<Opening>& openings, float x, int bay, int bays) {
    const uint32_t leaf = p_.door[hash64(seed_, 5) % p_.door.size()];
    const int door_bay =
        d_.front == Front::gate ? bays / 2 : static_cast<int>(hash64(seed_, 9) % static_cast<uint64_t>(bays));
    if (d_.front == Front::gate) {
      if (bay == door_bay) openings.push_back({x - 1.1f, x + 1.1f, 0.0f, 2.7f, leaf});
    } else if (bay == door_bay) {
      openings.push_back({x - 0.6f, x + 0.6f, 0.0f, 2.25f, leaf});
      door_x_ = x;
    } else if (d_.front == Front::shop) {
      openings.push_back({x - 0.95f, x + 0.95f, 0.45f, 2.35f, p_.window});
    } else {
      openings.push_back({x - 0.55f, x + 0.55f, 0.85f, 2.35f, glass()});
    }
  }

  /// Steps, awnings and flower boxes in front of the ground floor, in the front wall's frame.
  void frontage(float span, int bays) {
    if (d_.front != Front::gate) {
      b_.box(p_.ashlar[0], {door_x_ - 0.8f, -kFoundation, -0.1f}, {door_x_ + 0.8f, -0.02f, 0.55f}, kNoBottom | kNoBack);
    }
    if (d_.front == Front::shop) {
      awning(b_, p_.stripes[hash64(seed_, 6) % p_.stripes.size()], 0.25f, span - 0.25f, 3.0f);
    } else if (d_.front == Front::door && hash64(seed_, 7) % 2 == 0) {
      for (int bay = 0; bay < bays; ++bay) {
        const float x = (static_cast<float>(bay) + 0.5f) * kBay;
        if (x == door_x_) continue;
        b_.box(p_.planks[1], {x - 0.6f, 0.60f, -0.02f}, {x + 0.6f, 0.80f, 0.22f}, kNoBack | kNoTop);
        b_.box(p_.flowers, {x - 0.57f, 0.74f, 0.0f}, {x + 0.57f, 0.92f, 0.20f}, kNoBack | kNoBottom);
      }
    }
  }

  void roof(float width, float depth) {
    b_.setFrame(centre_);
    const uint32_t brick = p_.brick[hash64(seed_, 4) % 2];
    const float top = eaves() + d_.rise;
    const bool rows = d_.quarter == Quarter::centre;  // neighbours are close: little overhang at the sides
    switch (d_.roof) {
      case Roof::gable: {
        gableRoof(b_, d_.roof_cover, d_.wall, d_.trim, {width, depth, eaves(), d_.rise, 0.45f, rows ? 0.12f : 0.35f});
        dormers(width, 0.5f * depth * 0.72f, eaves() + d_.rise * 0.28f - 0.25f);
        break;
      }
      case Roof::gable_front: {
        b_.setFrame(centre_, 1);
        gableRoof(b_, d_.roof_cover, d_.wall, d_.trim, {depth, width, eaves(), d_.rise, rows ? 0.15f : 0.45f, 0.3f});
        b_.setFrame(centre_ + glm::vec3(0.0f, 0.0f, 0.5f * depth));
        framedWindow(b_, d_.trim, glass(), {-0.5f, eaves() + 0.5f}, {0.5f, eaves() + 1.8f});
        if (d_.rise > 4.5f) framedWindow(b_, d_.trim, glass(), {-0.35f, eaves() + 2.7f}, {0.35f, eaves() + 3.5f});
        break;
      }
      case Roof::hip: {
        hipRoof(b_, d_.roof_cover, d_.trim, {width, depth, eaves(), d_.rise, rows ? 0.25f : 0.5f});
        dormers(0.7f * width, 0.5f * depth * 0.75f, eaves() + d_.rise * 0.25f - 0.25f);
        break;
      }
      case Roof::mansard: {
        mansardRoof(b_, d_.roof_cover, d_.trim, {width, depth, eaves(), d_.rise});
        dormers(width, 0.5f * depth - 0.05f, eaves() + 0.5f);
        break;
      }
      case Roof::flat: {
        flatRoof(b_, p_.flat_roof, d_.wall, d_.trim, {width, depth, eaves(), 0.0f});
        break;
      }
    }
    b_.setFrame(centre_);
    for (int i = 0; i < d_.chimneys; ++i) {
      const float x = (i % 2 == 0 ? 0.30f : -0.34f) * width, z = -0.12f * depth;
      const float foot = d_.roof == Roof::flat ? eaves() : eaves() + 0.2f;
      const float height = d_.roof == Roof::flat ? 2.0f : top - foot + (d_.roof == Roof::mansard ? 3.1f : 0.7f);
      chimney(b_, brick, d_.trim, {x, foot, z}, height);
    }
  }

  void dormers(float width, float z, float y) {
    b_.setFrame(centre_);
    for (int i = 0; i < d_.dormers; ++i) {
      const float x = width * ((static_cast<float>(i) + 0.5f) / static_cast<float>(d_.dormers) - 0.5f);
      dormer(b_, d_.wall, d_.roof_cover, d_.trim, glass(), {x, y, z}, 2.2f);
    }
  }

  /// A wing with its own ridge towards the back: the house becomes an L.
  void wing(float width, float depth, float back_shift) {
    const float length = static_cast<float>(d_.wing) * kBay, wing_width = 2.0f * kBay;
    const glm::vec3 centre{-0.5f * width + 0.5f * wing_width + 0.2f, 0.0f, back_shift - 0.5f * (depth + length) + 0.3f};
    body(centre, 2, d_.wing, std::max(1, d_.storeys - 1), false);
    b_.setFrame(centre, 1);
    const float y = kPlinth + static_cast<float>(std::max(1, d_.storeys - 1)) * kStorey;
    gableRoof(b_, d_.roof_cover, d_.wall, d_.trim, {length, wing_width, y, 2.2f, 0.35f, 0.3f});
  }

  /// An octagonal turret at the street corner, one storey taller than the house.
  void tower(float width, float depth) {
    const float radius = 1.9f, height = eaves() + 2.4f;
    b_.setFrame(centre_ + glm::vec3(0.5f * width - 0.9f, 0.0f, 0.5f * depth - 0.9f));
    b_.prism(d_.wall, {0.0f, -kFoundation, 0.0f}, radius, radius, height + kFoundation, 8);
    b_.prism(d_.trim, {0.0f, height - 0.1f, 0.0f}, radius + 0.3f, radius + 0.3f, 0.25f, 8, true);
    b_.prism(p_.slate[0], {0.0f, height + 0.15f, 0.0f}, radius + 0.25f, 0.0f, 4.6f, 8);
    const float face = radius * 0.9239f;
    for (int side = 0; side < 2; ++side) {
      const glm::vec3 outward = side == 0 ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0);
      b_.setFrame(centre_ + glm::vec3(0.5f * width - 0.9f, 0.0f, 0.5f * depth - 0.9f) + outward * face, side);
      for (int storey = 1; storey <= d_.storeys; ++storey) {
        const float y = kPlinth + static_cast<float>(storey) * kStorey + (storey == d_.storeys ? 0.4f : 0.85f);
        framedWindow(b_, d_.trim, glass(), {-0.4f, y}, {0.4f, y + 1.3f});
      }
    }
  }

  const Palette& p_;
  const HouseDesign& d_;
  MeshBuilder b_;
  uint64_t seed_;
  glm::vec3 centre_{0.0f};
  float door_x_ = 0.0f;
  uint64_t windows_ = 0;
  int lit_ = 0;
};

std::vector<HouseDesign> designs(const Palette& p) {
  using enum Roof;
  constexpr Quarter C = Quarter::centre, T = Quarter::town, S = Quarter::suburb, F = Quarter::farm;
  const auto& pl = p.plaster;
  const auto& br = p.brick;
  const auto& tf = p.timber_frame;
  const auto& rt = p.roof_tiles;
  const auto& sl = p.slate;
  const uint32_t white = p.trim[0], sand = p.trim[1], dark = p.trim[2], ashlar = p.ashlar[0];
  return {
      // Merchants' rows around the market: narrow, tall, shops below.
      {C, 1.0f, 3, 5, 3, gable_front, 4.8f, tf[0], ashlar, rt[0], dark, Front::shop, 0, 1, 0, false, 2},
      {C, 1.0f, 3, 5, 4, gable_front, 5.2f, pl[1], ashlar, rt[1], white, Front::door, 0, 1, 0, false, 0},
      {C, 1.0f, 4, 5, 3, gable, 4.6f, pl[3], pl[3], rt[0], white, Front::shop, 2, 2, 0, false, 0},
      {C, 1.0f, 4, 5, 4, mansard, 1.5f, pl[0], ashlar, sl[0], sand, Front::shop, 3, 2, 0, false, 3},
      {C, 0.8f, 5, 5, 3, mansard, 1.4f, br[0], ashlar, sl[1], sand, Front::door, 3, 2, 0, false, 0},
      {C, 1.0f, 3, 4, 4, gable, 4.0f, tf[1], pl[1], rt[2], dark, Front::shop, 1, 1, 0, false, 0},
      {C, 0.6f, 5, 5, 4, hip, 3.6f, pl[2], ashlar, rt[1], sand, Front::shop, 2, 2, 0, true, 0},
      {C, 0.7f, 4, 4, 4, flat, 0.0f, br[2], ashlar, sl[0], sand, Front::shop, 0, 1, 0, false, 2},
      {C, 0.9f, 2, 5, 4, gable_front, 3.9f, br[0], br[0], rt[3], sand, Front::door, 0, 1, 0, false, 0},
      {C, 0.9f, 3, 5, 3, gable_front, 4.4f, pl[6], pl[0], rt[4], white, Front::shop, 0, 1, 0, false, 0},
      {C, 0.6f, 6, 5, 3, gable, 4.4f, pl[4], ashlar, rt[2], sand, Front::shop, 3, 2, 0, false, 0},
      // Town houses.
      {T, 1.0f, 3, 4, 2, gable, 3.8f, pl[0], pl[0], rt[0], dark, Front::door, 1, 1, 0, false, 0},
      {T, 1.0f, 4, 4, 2, gable, 3.8f, tf[0], pl[0], rt[1], dark, Front::door, 0, 1, 0, false, 2},
      {T, 1.0f, 4, 4, 3, hip, 3.0f, pl[1], pl[1], rt[0], white, Front::door, 0, 2, 0, false, 0},
      {T, 0.9f, 3, 4, 3, gable_front, 3.9f, pl[5], ashlar, rt[2], white, Front::door, 0, 1, 0, false, 0},
      {T, 0.9f, 4, 4, 3, mansard, 1.3f, pl[7], ashlar, sl[0], white, Front::door, 2, 2, 0, false, 0},
      {T, 0.9f, 5, 4, 2, gable, 4.0f, br[1], br[1], rt[3], sand, Front::door, 2, 2, 0, false, 0},
      {T, 0.8f, 3, 4, 3, gable, 3.8f, tf[2], tf[2], rt[4], dark, Front::shop, 1, 1, 0, false, 0},
      {T, 0.7f, 4, 4, 2, gable, 3.8f, pl[2], pl[2], rt[1], white, Front::door, 1, 1, 3, false, 0},
      {T, 0.6f, 4, 4, 3, hip, 3.2f, pl[3], pl[3], sl[1], white, Front::door, 0, 1, 0, true, 2},
      {T, 0.5f, 6, 4, 3, flat, 0.0f, br[0], ashlar, sl[0], sand, Front::door, 0, 2, 0, false, 0},
      // Cottages and villas with gardens.
      {S, 1.0f, 3, 3, 1, gable, 3.4f, pl[0], pl[0], rt[0], dark, Front::door, 1, 1, 0, false, 0},
      {S, 1.0f, 4, 3, 1, gable, 3.6f, tf[0], tf[0], rt[2], dark, Front::door, 1, 1, 0, false, 0},
      {S, 1.0f, 4, 3, 1, hip, 2.6f, pl[1], pl[1], rt[1], white, Front::door, 0, 1, 0, false, 1},
      {S, 0.9f, 3, 4, 2, gable_front, 3.4f, pl[6], pl[6], rt[3], white, Front::door, 0, 1, 0, false, 0},
      {S, 0.8f, 4, 4, 2, hip, 2.8f, pl[3], pl[3], sl[0], white, Front::door, 0, 2, 0, false, 0},
      {S, 0.8f, 4, 3, 1, gable, 3.4f, br[0], br[0], rt[3], white, Front::door, 2, 1, 2, false, 0},
      {S, 0.8f, 3, 3, 2, gable, 3.2f, p.planks[2], p.planks[2], rt[2], white, Front::door, 0, 1, 0, false, 1},
      {S, 0.6f, 4, 4, 2, gable, 3.4f, pl[5], br[0], rt[0], white, Front::door, 1, 2, 2, false, 0},
      // Farms, barns, warehouses.
      {F, 1.0f, 5, 4, 1, gable, 4.2f, tf[0], tf[0], rt[2], dark, Front::door, 0, 1, 0, false, 0},
      {F, 1.0f, 6, 4, 1, gable, 4.6f, p.planks[2], p.planks[2], rt[3], white, Front::gate, 0, 0, 0, false, 0},
      {F, 0.8f, 4, 6, 2, gable_front, 4.2f, p.planks[3], ashlar, rt[2], dark, Front::gate, 0, 0, 0, false, 0},
      {T, 0.4f, 6, 5, 3, gable, 4.2f, br[1], br[1], sl[1], sand, Front::gate, 0, 0, 0, false, 0},
      {C, 0.3f, 4, 6, 4, gable_front, 4.4f, br[1], br[1], rt[3], sand, Front::gate, 0, 0, 0, false, 0},
  };
}

}  // namespace

void addHouses(Catalogue& catalogue) {
  const std::vector<HouseDesign> table = designs(catalogue.palette);
  for (size_t i = 0; i < table.size(); ++i) {
    std::string name = "house_";
    name += static_cast<char>('0' + i / 10);
    name += static_cast<char>('0' + i % 10);
    Mesh mesh = HouseBuilder(std::move(name), catalogue.palette, table[i], hash64(i + 1)).build();
    const uint32_t prefab = catalogue.add(std::move(mesh), "house");
    catalogue.houses.push_back({prefab, table[i].quarter, table[i].weight});
  }
}

}  // namespace helio::scene
