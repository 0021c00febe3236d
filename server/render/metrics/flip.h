// FLIP: how different two pictures look to somebody who flips between them [Andersson et al. 2020, FLIP: A Difference
// Evaluator for Alternating Images].
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace helio::metrics {

/// Pixels of the display to a degree of the visual field: 3840 pixels on 0.7 m, seen from 0.7 m, as in the paper.
inline constexpr double kPixelsPerDegree = 67.0206;

/// A picture as it is seen: worth keeping where several are compared with it.
class SeenPicture {
 public:
  /// `width` x `height` pixels of 4 bytes, sRGB, rows top-down.
  SeenPicture(const uint8_t* rgbx, uint32_t width, uint32_t height, double pixels_per_degree = kPixelsPerDegree);

  /// The difference of each pixel, [0, 1]; `other` has the same size.
  std::vector<float> differences(const SeenPicture& other) const;
  /// Its mean over the pixels.
  double difference(const SeenPicture& other) const;

 private:
  std::vector<glm::dvec3> colours_;  // CIELAB, Hunt-adjusted, behind the eye's filter
  std::vector<double> edges_, points_;
};

}  // namespace helio::metrics
