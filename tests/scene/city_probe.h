// Measures a generated city from its scene alone: what stands where, how high the ground is, what a hash of it all is.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/city.h"
#include "scene/polygon.h"

namespace helio::scene {

/// FNV-1a over every byte that a scene's meaning depends on.
uint64_t hashScene(const Scene& scene);

/// The city for a seed and count, generated once in a test program.
const Scene& cityOf(uint64_t seed, uint32_t instances);

/// What a placement covers of the ground (its mesh's bounds turned with it).
Rectangle footprintOf(const Scene& scene, const Placement& placement);

/// Height of the terrain's surface below a point, found on its triangles.
class GroundProbe {
 public:
  explicit GroundProbe(const Scene& scene);
  /// The highest surface at (x, z); -infinity where there is none.
  float height(glm::dvec2 p) const;

 private:
  struct Tile {
    const Mesh* mesh;
    glm::mat4x3 transform;
    Aabb box;
  };
  static int64_t key(int64_t x, int64_t z) { return x * 100'000 + z; }
  std::map<int64_t, std::vector<Tile>> tiles_;
};

}  // namespace helio::scene
