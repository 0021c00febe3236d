// Filling one block: houses along its streets, then street furniture, gardens, parks, fields.
#pragma once

#include <vector>

#include "scene/city_furnish.h"
#include "scene/random.h"

namespace helio::scene {

/// A wish for something to stand somewhere; the first in order of `priority` are granted.
struct Wish {
  uint64_t priority;
  Stand stand;
};

/// What fills one block. Fixed things must stand; optional ones give way when there are too many instances.
class LotFiller {
 public:
  LotFiller(const CityPlan& plan, const Catalogue& catalogue, const Block& block);

  /// Stands things that were placed before the rest of the block.
  void reserve(const Stand& stand);
  /// Everything that the block's use calls for. `keep_clear`: no trees or stalls within 12 m.
  void fill(const glm::dvec2& keep_clear);

  std::vector<Stand> fixed;
  std::vector<Wish> optional;

 private:
  void square(const glm::dvec2& keep_clear);
  void homes();
  void park();
  void field();
  void orchard();
  void meadow();

  void row(size_t edge);
  bool placeHouse(const glm::dvec2& a, const glm::dvec2& along, double& t, double length, double setback);
  void streetFurniture();
  void gardens();
  void boundary(uint32_t prefab, double inset_distance, double share);
  void farmstead();
  void hedgerow();

  bool taken(const glm::dvec2& p, double radius) const;
  bool onPath(const glm::dvec2& p) const;
  bool stand(uint32_t prefab, const glm::dvec2& p, const glm::dvec2& front, double clearance, bool is_fixed,
             float scale = 1.0f);
  uint32_t chooseHouse(Quarter quarter);
  uint32_t chooseTree(bool garden);
  glm::dvec2 anyDirection() { return unitVector(random_.uniform()); }
  double level(const glm::dvec2& p) const { return plan_.ground.height(p) + static_cast<double>(block_.raise); }

  const CityPlan& plan_;
  const Catalogue& catalogue_;
  const Block& block_;
  Random random_;
  std::vector<Rectangle> buildings_;
  struct Spot {
    glm::dvec2 p;
    double radius;
  };
  std::vector<Spot> spots_;
};

/// A stand for a building: its floor a little above the highest ground around it, its front wall on `front_line`.
Stand standBuilding(const CityPlan& plan, const Catalogue& catalogue, const Block& block, uint32_t prefab,
                    const glm::dvec2& position, const glm::dvec2& front);

}  // namespace helio::scene
