#include "render/metrics/image.h"

#include <algorithm>
#include <cmath>

namespace helio::metrics {

double relativeSquare(float a, float b) {
  const double value = static_cast<double>(b), difference = static_cast<double>(a) - value;
  return difference * difference / (value * value + kEpsilon);
}

glm::dvec3 mean(const Image& image) {
  glm::dvec3 sum(0.0);
  for (size_t i = 0; i < image.rgb.size(); i += 3) sum += glm::dvec3(image.rgb[i], image.rgb[i + 1], image.rgb[i + 2]);
  return sum / (static_cast<double>(image.rgb.size()) / 3.0);
}

double relativeMse(const Image& a, const Image& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.rgb.size(); ++i) sum += relativeSquare(a.rgb[i], b.rgb[i]);
  return sum / static_cast<double>(a.rgb.size());
}

namespace {

/// Averages over 11 x 11 Gaussian windows, one a pixel; windows end at the border.
std::vector<double> blurred(const std::vector<double>& values, size_t width, size_t height) {
  constexpr int kRadius = 5;
  constexpr double kSigma = 1.5;
  std::vector<double> window;
  for (int k = -kRadius; k <= kRadius; ++k) window.push_back(std::exp(-0.5 * k * k / (kSigma * kSigma)));
  const auto along = [&](const std::vector<double>& from, bool rows) {
    std::vector<double> to(from.size());
    for (size_t y = 0; y < height; ++y)
      for (size_t x = 0; x < width; ++x) {
        double sum = 0.0, weights = 0.0;
        for (int64_t k = -kRadius; k <= kRadius; ++k) {
          const auto at = static_cast<int64_t>(rows ? x : y) + k;
          if (at < 0 || at >= static_cast<int64_t>(rows ? width : height)) continue;
          const double weight = window[static_cast<size_t>(k + kRadius)];
          sum += weight * from[rows ? y * width + static_cast<size_t>(at) : static_cast<size_t>(at) * width + x];
          weights += weight;
        }
        to[y * width + x] = sum / weights;
      }
    return to;
  };
  return along(along(values, true), false);
}

std::vector<double> tonemappedLuminance(const Image& image, double scale) {
  std::vector<double> values;
  for (size_t i = 0; i < image.rgb.size(); i += 3) {
    const double luminance =
        std::max(0.0, 0.2126 * static_cast<double>(image.rgb[i]) + 0.7152 * static_cast<double>(image.rgb[i + 1]) +
                          0.0722 * static_cast<double>(image.rgb[i + 2]));
    values.push_back(std::pow(scale * luminance / (1.0 + scale * luminance), 1.0 / 2.2));
  }
  return values;
}

}  // namespace

double ssim(const Image& a, const Image& b) {
  const glm::dvec3 average = mean(b);
  const double luminance = glm::dot(average, glm::dvec3(0.2126, 0.7152, 0.0722));
  const double scale = luminance > 0.0 ? 0.18 / luminance : 1.0;
  return ssim(tonemappedLuminance(a, scale), tonemappedLuminance(b, scale), b.width, b.height);
}

double ssim(const std::vector<double>& x, const std::vector<double>& y, uint32_t width, uint32_t height) {
  const auto product = [](const std::vector<double>& u, const std::vector<double>& v) {
    std::vector<double> w(u.size());
    for (size_t i = 0; i < u.size(); ++i) w[i] = u[i] * v[i];
    return w;
  };
  const auto blur = [&](const std::vector<double>& v) { return blurred(v, width, height); };
  const std::vector<double> mx = blur(x), my = blur(y), xx = blur(product(x, x)), yy = blur(product(y, y)),
                            xy = blur(product(x, y));
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  double sum = 0.0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double vx = xx[i] - mx[i] * mx[i], vy = yy[i] - my[i] * my[i], cov = xy[i] - mx[i] * my[i];
    sum += (2.0 * mx[i] * my[i] + kC1) * (2.0 * cov + kC2) / ((mx[i] * mx[i] + my[i] * my[i] + kC1) * (vx + vy + kC2));
  }
  return sum / static_cast<double>(x.size());
}

double noiseFloor(const Image& first, const Image& second) {
  double sum = 0.0;
  for (size_t i = 0; i < first.rgb.size(); ++i) {
    const double half = 0.5 * (static_cast<double>(first.rgb[i]) - static_cast<double>(second.rgb[i]));
    const double middle = 0.5 * (static_cast<double>(first.rgb[i]) + static_cast<double>(second.rgb[i]));
    sum += half * half / (middle * middle + kEpsilon);
  }
  return sum / static_cast<double>(first.rgb.size());
}

Image rest(const Image& all, uint32_t n, const Image& part, uint32_t k) {
  Image result = all;
  for (size_t i = 0; i < all.rgb.size(); ++i)
    result.rgb[i] = static_cast<float>((n * static_cast<double>(all.rgb[i]) - k * static_cast<double>(part.rgb[i])) /
                                       static_cast<double>(n - k));
  return result;
}

double luma(const uint8_t* pixel) { return (0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2]) / 255.0; }

std::vector<double> lumas(const std::vector<uint8_t>& rgbx) {
  std::vector<double> values;
  for (size_t i = 0; i < rgbx.size(); i += 4) values.push_back(luma(&rgbx[i]));
  return values;
}

std::vector<uint8_t> heat(const std::vector<float>& differences) {
  const glm::vec3 stops[] = {{0, 0, 4}, {114, 31, 129}, {241, 96, 93}, {252, 253, 191}};
  std::vector<uint8_t> rgba;
  for (const float d : differences) {
    const float t = 3.0f * std::clamp(d, 0.0f, 1.0f);
    const int i = std::min(2, static_cast<int>(t));
    const glm::vec3 c = glm::mix(stops[i], stops[i + 1], t - static_cast<float>(i));
    rgba.insert(rgba.end(), {static_cast<uint8_t>(c.r), static_cast<uint8_t>(c.g), static_cast<uint8_t>(c.b), 255});
  }
  return rgba;
}

}  // namespace helio::metrics
