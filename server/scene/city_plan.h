// The city's plan: where the town, the woods and the fields lie, the streets between blocks, and the ground under all.
// Coordinates (x, z) in metres, the world's centre at the origin.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/catalogue.h"
#include "scene/city.h"
#include "scene/polygon.h"

namespace helio::scene {

inline constexpr double kTile = 64.0;    ///< metres: side of a terrain tile
inline constexpr double kLattice = 8.0;  ///< metres between samples of the height field
inline constexpr double kHitbox = 16.0;  ///< metres: side of a hitbox cell, the unit of density

/// Size and lie of the land for a number of instances.
struct Site {
  uint64_t seed = 1;
  double side = 0.0;   ///< metres, a multiple of kTile
  double apron = 0.0;  ///< metres of bare hills around the populated square
  glm::dvec2 town_centre{0.0};
  double town_radius = 0.0;
  double square_half = 0.0;  ///< half the side of the market square

  explicit Site(const CityParameters& parameters);
  double half() const { return 0.5 * side; }
  /// 1 in the market square, 0 at the town's uneven edge, negative outside.
  double urbanity(const glm::dvec2& p) const;
  /// Above 0 in the woods.
  double woodland(const glm::dvec2& p) const;
};

/// A gentle height field: samples every 8 m, linear on the two triangles of each lattice square (which share the
/// diagonal from low x, low z to high x, high z).
class HeightField {
 public:
  explicit HeightField(const Site& site);

  /// Metres; anywhere, also on the apron.
  double height(const glm::dvec2& p) const;
  glm::vec3 normal(const glm::dvec2& p) const;
  double lowest(const Rectangle& rectangle) const;  ///< over corners and centre
  double highest(const Rectangle& rectangle) const;
  HeightGrid grid() const;  ///< the same, for who needs no more than the populated square

 private:
  double shape(const glm::dvec2& p) const;
  double sample(int64_t ix, int64_t iz) const;

  Site site_;
  int64_t count_;  ///< samples along one side
  std::vector<float> samples_;
};

struct Street {
  double half_width = 0.0;  ///< metres from the middle to the kerb
  double pavement = 0.0;    ///< metres of pavement on either side where the block is built up
  uint32_t surface = 0;     ///< material
  int rank = 0;             ///< 0 none, 1 track, 2 lane, 3 street, 4 avenue or country road
};

/// A painted part of a block: convex.
struct Zone {
  Polygon polygon;
  uint32_t surface = 0;
  glm::dvec2 axis{1.0, 0.0};  ///< direction of the texture's u
};

enum class Use { square, homes, park, field, orchard, meadow, forest };

/// A convex piece of land between the middles of the streets around it. Blocks cover the world.
struct Block {
  Polygon outline;
  std::vector<Street> streets;  ///< one for each edge of the outline
  Use use = Use::meadow;
  Quarter quarter = Quarter::farm;
  float raise = 0.0f;       ///< metres of the kerb's top above the street
  Polygon kerb;             ///< inside the streets
  Polygon lot;              ///< inside the pavement
  uint32_t pavement = 0;    ///< material between kerb and lot
  std::vector<Zone> zones;  ///< painted in order: the first zone that covers a point wins
  uint64_t seed = 0;

  bool builtUp() const { return use == Use::square || use == Use::homes || use == Use::park; }
  /// The street along an edge that runs like a -> b.
  const Street& streetAlong(const glm::dvec2& a, const glm::dvec2& b) const;
};

struct CityPlan {
  Site site;
  HeightField ground;
  std::vector<Block> blocks;
  uint32_t market = 0;  ///< index of the square's block
};

CityPlan planCity(const CityParameters& parameters, const Palette& palette);

/// Terrain meshes: one for each tile in rows, then four for the apron. Positions are relative to `centres`.
struct Ground {
  std::vector<Mesh> meshes;
  std::vector<glm::dvec2> centres;
};
Ground buildGround(const CityPlan& plan, const Palette& palette);

}  // namespace helio::scene
