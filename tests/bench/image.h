// Pictures of linear radiance, and how far apart two of them are.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/result.h"

namespace helio::bench {

/// Rows top-down, three floats a pixel.
struct Image {
  uint32_t width = 0, height = 0;
  std::vector<float> rgb;
};

/// A colour PFM of either byte order. Errors: not_found, invalid.
Result<Image> readPfm(const std::string& path);

glm::dvec3 mean(const Image& image);

/// Mean over pixels and channels of (a - b)^2 / (b^2 + 0.01). Both are of the same size.
double relativeMse(const Image& a, const Image& b);

/// The median over pixels of the same, each the mean of its channels: blind to a few bright outliers.
double medianRelativeSquare(const Image& a, const Image& b);

/// Share, 0 to 1, of relativeMse's sum that the worst `fraction` of the pixels hold.
double shareOfWorst(const Image& a, const Image& b, double fraction);

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

/// As ssim() sees it, but in colour: scaled so that the mean luminance of `exposure` is middle grey, compressed,
/// encoded; four bytes a pixel.
std::vector<uint8_t> tonemapped(const Image& image, const Image& exposure);

/// Signed relative difference as a picture: grey where equal, redder where `a` is brighter, bluer where darker; full
/// colour at `scale`.
std::vector<uint8_t> differencePicture(const Image& a, const Image& b, double scale);

}  // namespace helio::bench
