#include "render/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <numeric>

namespace helio::metrics {
namespace {

using glm::dvec3;
using Plane = std::vector<double>;

constexpr double kPi = 3.14159265358979323846;

struct Size {
  size_t width, height;
};

/// Odd number of weights around the middle.
using Kernel = std::vector<double>;

/// Along rows, then along columns; the border goes on beyond the picture.
Plane convolve(const Plane& from, Size size, const Kernel& across, const Kernel& down) {
  const auto along = [&](const Plane& in, const Kernel& kernel, bool rows) {
    const auto radius = static_cast<int64_t>(kernel.size() / 2);
    const auto last = static_cast<int64_t>(rows ? size.width : size.height) - 1;
    Plane out(in.size());
    for (size_t y = 0; y < size.height; ++y)
      for (size_t x = 0; x < size.width; ++x) {
        double sum = 0.0;
        for (int64_t k = -radius; k <= radius; ++k) {
          const auto at = static_cast<size_t>(std::clamp(static_cast<int64_t>(rows ? x : y) + k, int64_t{0}, last));
          sum += kernel[static_cast<size_t>(k + radius)] * in[rows ? y * size.width + at : at * size.width + x];
        }
        out[y * size.width + x] = sum;
      }
    return out;
  };
  return along(along(from, across, true), down, false);
}

template <typename F>
Kernel kernelOf(int radius, const F& weight) {
  Kernel kernel;
  for (int x = -radius; x <= radius; ++x) kernel.push_back(weight(static_cast<double>(x)));
  return kernel;
}

double sumOf(const Kernel& kernel) { return std::accumulate(kernel.begin(), kernel.end(), 0.0); }

// ---- Colour spaces. D65 is what (1, 1, 1) of linear sRGB is. ----

const glm::dmat3 kRgbToXyz =
    glm::transpose(glm::dmat3(10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0,
                              2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0,
                              1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0));
const glm::dmat3 kXyzToRgb = glm::inverse(kRgbToXyz);
const dvec3 kWhite = kRgbToXyz * dvec3(1.0);

double linear(uint8_t code) {
  static const std::array<double, 256> table = [] {
    std::array<double, 256> values{};
    for (size_t i = 0; i < values.size(); ++i) {
      const double v = static_cast<double>(i) / 255.0;
      values[i] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    }
    return values;
  }();
  return table[code];
}

/// Opponent colours that are linear in radiance: what the eye filters by contrast sensitivity.
dvec3 toYCxCz(const dvec3& rgb) {
  const dvec3 xyz = kRgbToXyz * rgb / kWhite;
  return {116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)};
}
dvec3 fromYCxCz(const dvec3& ycxcz) {
  const double y = (ycxcz.x + 16.0) / 116.0;
  return kXyzToRgb * (kWhite * dvec3(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0));
}

/// CIELAB with Hunt's adjustment: colours are told apart less in the dark.
dvec3 toHuntLab(const dvec3& rgb) {
  const dvec3 xyz = kRgbToXyz * rgb / kWhite;
  constexpr double kDelta = 6.0 / 29.0;
  const auto f = [](double t) {
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0 * kDelta * kDelta) + 4.0 / 29.0;
  };
  const double fy = f(xyz.y), lightness = 116.0 * fy - 16.0;
  return {lightness, 0.01 * lightness * 500.0 * (f(xyz.x) - fy), 0.01 * lightness * 200.0 * (fy - f(xyz.z))};
}

/// HyAB [Abasi et al. 2020]: of large colour differences.
double hyab(const dvec3& a, const dvec3& b) {
  return std::abs(a.x - b.x) + std::sqrt((a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

// ---- The colour pipeline, section 4.1 ----

constexpr double kColourExponent = 0.7, kKneeAt = 0.4, kKneeValue = 0.95;

struct Gaussian {
  double a, b;
};
/// Contrast sensitivity of achromatic, red-green and blue-yellow, as sums of Gaussians (table 1).
const std::array<std::vector<Gaussian>, 3> kSensitivity{
    {{{1.0, 0.0047}}, {{1.0, 0.0053}}, {{34.1, 0.04}, {13.5, 0.025}}}};

Plane asTheEyeSees(const Plane& plane, Size size, const std::vector<Gaussian>& sensitivity, double pixels_per_degree) {
  const int radius = static_cast<int>(std::ceil(3.0 * std::sqrt(0.04 / (2.0 * kPi * kPi)) * pixels_per_degree));
  Plane seen(plane.size(), 0.0);
  double total = 0.0;
  for (const Gaussian& g : sensitivity) {
    const Kernel kernel = kernelOf(radius, [&](double x) {
      const double degrees = x / pixels_per_degree;
      return std::exp(-kPi * kPi * degrees * degrees / g.b);
    });
    const double weight = g.a * std::sqrt(kPi / g.b);
    total += weight * sumOf(kernel) * sumOf(kernel);
    const Plane part = convolve(plane, size, kernel, kernel);
    for (size_t i = 0; i < seen.size(); ++i) seen[i] += weight * part[i];
  }
  for (double& value : seen) value /= total;
  return seen;
}

/// Large differences are compressed: between greens and blues they are so large that others would not count.
double compressed(double difference) {
  static const double most = std::pow(hyab(toHuntLab({0, 1, 0}), toHuntLab({0, 0, 1})), kColourExponent);
  const double knee = kKneeAt * most, powered = std::pow(difference, kColourExponent);
  return powered < knee ? kKneeValue / knee * powered
                        : kKneeValue + (powered - knee) / (most - knee) * (1.0 - kKneeValue);
}

// ---- The feature pipeline, section 4.2 ----

/// Magnitude of the first (edges) or second (points) derivative of the lightness.
Plane features(const Plane& lightness, Size size, bool points, double pixels_per_degree) {
  const double deviation = 0.5 * 0.082 * pixels_per_degree;
  const int radius = static_cast<int>(std::ceil(3.0 * deviation));
  const auto gaussian = [&](double x) { return std::exp(-0.5 * x * x / (deviation * deviation)); };
  Kernel smooth = kernelOf(radius, gaussian);
  const double sum = sumOf(smooth);
  for (double& weight : smooth) weight /= sum;
  Kernel derivative =
      kernelOf(radius, [&](double x) { return (points ? x * x / (deviation * deviation) - 1.0 : -x) * gaussian(x); });
  double positive = 0.0, negative = 0.0;
  for (const double weight : derivative) (weight > 0.0 ? positive : negative) += std::abs(weight);
  for (double& weight : derivative) weight /= weight > 0.0 ? positive : negative;
  const Plane across = convolve(lightness, size, derivative, smooth),
              down = convolve(lightness, size, smooth, derivative);
  Plane magnitude(lightness.size());
  for (size_t i = 0; i < magnitude.size(); ++i) magnitude[i] = std::hypot(across[i], down[i]);
  return magnitude;
}

}  // namespace

SeenPicture::SeenPicture(const uint8_t* rgbx, uint32_t width, uint32_t height, double pixels_per_degree) {
  const Size size{width, height};
  std::array<Plane, 3> opponent;
  Plane lightness;
  for (size_t i = 0; i < size.width * size.height; ++i) {
    const dvec3 c = toYCxCz({linear(rgbx[4 * i]), linear(rgbx[4 * i + 1]), linear(rgbx[4 * i + 2])});
    for (int channel = 0; channel < 3; ++channel) opponent[static_cast<size_t>(channel)].push_back(c[channel]);
    lightness.push_back((c.x + 16.0) / 116.0);
  }
  edges_ = features(lightness, size, false, pixels_per_degree);
  points_ = features(lightness, size, true, pixels_per_degree);
  for (size_t channel = 0; channel < 3; ++channel)
    opponent[channel] = asTheEyeSees(opponent[channel], size, kSensitivity[channel], pixels_per_degree);
  for (size_t i = 0; i < lightness.size(); ++i)
    colours_.push_back(
        toHuntLab(glm::clamp(fromYCxCz({opponent[0][i], opponent[1][i], opponent[2][i]}), dvec3(0.0), dvec3(1.0))));
}

std::vector<float> SeenPicture::differences(const SeenPicture& other) const {
  std::vector<float> difference;
  difference.reserve(colours_.size());
  for (size_t i = 0; i < colours_.size(); ++i) {
    const double colour = compressed(hyab(colours_[i], other.colours_[i]));
    const double feature = std::sqrt(
        std::max(std::abs(edges_[i] - other.edges_[i]), std::abs(points_[i] - other.points_[i])) / std::sqrt(2.0));
    difference.push_back(static_cast<float>(std::pow(colour, 1.0 - std::min(feature, 1.0))));
  }
  return difference;
}

double SeenPicture::difference(const SeenPicture& other) const {
  const std::vector<float> all = differences(other);
  return std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
}

}  // namespace helio::metrics
