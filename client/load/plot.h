// What one client has built, and whether the world still has it.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "lib/connection.h"

namespace helio::load {

namespace v1 = heliograph::v1;

/// A circle of the world in which one client builds and destroys, and no other. Every placement has a height that no
/// other has, so that it is known again. One thread at a time.
class Plot {
 public:
  static constexpr float kSpacing = 60;  ///< metres between the middles of two plots
  static constexpr float kBuildRadius = 16, kRadius = 25;

  /// The `index`-th plot of a world, on a square spiral around the middle of `bounds`.
  Plot(std::string world, const v1::Bounds& bounds, uint32_t index);

  /// The middle of the index-th cell of a square spiral: (0, 0), (1, 0), (1, 1), (0, 1), (-1, 1), ...
  static glm::ivec2 spiral(uint32_t index);

  /// Edits, and what became of them.
  v1::ApplyEditsRequest build(const std::string& prefab, uint32_t count);
  v1::ApplyEditsRequest destroy() const;
  void built(const v1::ApplyEditsRequest& request, const Result<v1::ApplyEditsResponse>& answer);
  void destroyed(const Result<v1::ApplyEditsResponse>& answer);

  struct Verdict {
    uint64_t lost = 0;     ///< acknowledged as built and not there, or as destroyed and there
    uint64_t doubled = 0;  ///< there more often than built
  };
  /// Compares with the world's instances in this plot.
  Verdict verify(const std::vector<v1::Instance>& instances) const;

  const std::string& world() const { return world_; }
  const glm::vec2& middle() const { return middle_; }
  bool used() const { return next_ > 0; }

 private:
  float heightOf(uint64_t number) const;

  /// What is known of a placement.
  enum class State { standing, gone, unknown };

  std::string world_;
  glm::vec2 middle_;
  float ground_;
  uint64_t next_ = 0;
  std::map<uint64_t, State> placements_;  ///< by number
};

/// The buildable prefab of that name; without a name the smallest that fits into a plot. Errors: there is none.
Result<std::string> choosePrefab(const std::vector<v1::Prefab>& prefabs, const std::string& name);

}  // namespace helio::load
