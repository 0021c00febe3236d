// Pictures of linear radiance, and how far apart two of them are.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace helio::metrics {

/// Rows top-down, three floats a pixel.
struct Image {
  uint32_t width = 0, height = 0;
  std::vector<float> rgb;
};

/// Of relative errors: what is darker than 0.1 counts absolutely.
constexpr double kEpsilon = 0.01;

/// (a - b)^2 / (b^2 + kEpsilon).
double relativeSquare(float a, float b);

glm::dvec3 mean(const Image& image);

/// Mean over pixels and channels of relativeSquare(). Both are of the same size.
double relativeMse(const Image& a, const Image& b);

/// Structural similarity of the tonemapped luminances, 1 for equal pictures [Wang et al. 2004]: Gaussian windows of 11
/// pixels, sigma 1.5. Both are scaled so that the mean luminance of `b` is middle grey, compressed by x / (1 + x), and
/// encoded with a gamma of 2.2.
double ssim(const Image& a, const Image& b);
/// The same of two pictures' luma, [0, 1], row by row.
double ssim(const std::vector<double>& a, const std::vector<double>& b, uint32_t width, uint32_t height);

/// The relative mean square error against the truth that the mean of two independent images of one sample count has
/// from noise alone, estimated from their difference.
double noiseFloor(const Image& first, const Image& second);

/// What `all` samples have without the first `part` of them: (n mean(n) - k mean(k)) / (n - k).
Image rest(const Image& all, uint32_t n, const Image& part, uint32_t k);

/// Of a pixel of 8 bits a channel, gamma-encoded as displayed, [0, 1].
double luma(const uint8_t* pixel);
/// Of pixels of 4 bytes each.
std::vector<double> lumas(const std::vector<uint8_t>& rgbx);

/// Differences of pixels, [0, 1], as a picture: black, purple, orange, white; four bytes a pixel.
std::vector<uint8_t> heat(const std::vector<float>& differences);

}  // namespace helio::metrics
