#include "bench/image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <numeric>

namespace helio::bench {
namespace {

constexpr double kEpsilon = 0.01;  // of relative errors: what is darker than 0.1 counts absolutely

/// (a - b)^2 / (b^2 + 0.01).
double relativeSquare(float a, float b) {
  const double value = static_cast<double>(b), difference = static_cast<double>(a) - value;
  return difference * difference / (value * value + kEpsilon);
}

/// Of each pixel, the mean of its channels.
std::vector<double> relativeSquares(const Image& a, const Image& b) {
  std::vector<double> pixels;
  for (size_t i = 0; i + 2 < a.rgb.size(); i += 3) {
    double sum = 0.0;
    for (size_t c = i; c < i + 3; ++c) sum += relativeSquare(a.rgb[c], b.rgb[c]);
    pixels.push_back(sum / 3.0);
  }
  return pixels;
}

}  // namespace

Result<Image> readPfm(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{ErrorKind::not_found, "there is no file " + path, "pfm", path, {}};
  std::string magic;
  Image image;
  double scale = 0.0;
  file >> magic >> image.width >> image.height >> scale;
  file.get();  // the one white space before the floats
  if (!file || magic != "PF" || scale == 0.0 || image.width == 0 || image.height == 0 || image.width > 16'384 ||
      image.height > 16'384)
    return invalid("pfm", path, path + " is no colour PFM");
  const size_t row = size_t{3} * image.width;
  image.rgb.resize(row * image.height);
  for (size_t y = image.height; y-- > 0;)
    file.read(reinterpret_cast<char*>(image.rgb.data() + y * row), static_cast<std::streamsize>(row * sizeof(float)));
  if (!file) return invalid("pfm", path, path + " ends before its last row");
  if ((scale < 0.0) != (std::endian::native == std::endian::little))
    for (float& value : image.rgb) {
      auto* bytes = reinterpret_cast<std::byte*>(&value);
      std::reverse(bytes, bytes + sizeof value);
    }
  return image;
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

double medianRelativeSquare(const Image& a, const Image& b) {
  std::vector<double> pixels = relativeSquares(a, b);
  const auto middle = pixels.begin() + static_cast<std::ptrdiff_t>(pixels.size() / 2);
  std::nth_element(pixels.begin(), middle, pixels.end());
  return *middle;
}

double shareOfWorst(const Image& a, const Image& b, double fraction) {
  std::vector<double> pixels = relativeSquares(a, b);
  std::sort(pixels.begin(), pixels.end(), std::greater<>());
  const auto worst = pixels.begin() + std::lround(fraction * static_cast<double>(pixels.size()));
  return std::accumulate(pixels.begin(), worst, 0.0) / std::accumulate(pixels.begin(), pixels.end(), 0.0);
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
        for (int k = -kRadius; k <= kRadius; ++k) {
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

std::vector<uint8_t> tonemapped(const Image& image, const Image& exposure) {
  const glm::dvec3 average = mean(exposure);
  const double scale = 0.18 / std::max(1e-9, glm::dot(average, glm::dvec3(0.2126, 0.7152, 0.0722)));
  std::vector<uint8_t> rgbx;
  for (size_t i = 0; i < image.rgb.size(); i += 3) {
    for (size_t c = 0; c < 3; ++c) {
      const double value = scale * std::max(0.0, static_cast<double>(image.rgb[i + c]));
      rgbx.push_back(static_cast<uint8_t>(std::lround(255.0 * std::pow(value / (1.0 + value), 1.0 / 2.2))));
    }
    rgbx.push_back(255);
  }
  return rgbx;
}

std::vector<uint8_t> differencePicture(const Image& a, const Image& b, double scale) {
  std::vector<uint8_t> rgba;
  for (size_t i = 0; i < a.rgb.size(); i += 3) {
    double sum_a = 0.0, sum_b = 0.0;
    for (size_t c = 0; c < 3; ++c) {
      sum_a += static_cast<double>(a.rgb[i + c]);
      sum_b += static_cast<double>(b.rgb[i + c]);
    }
    const double t = std::clamp((sum_a - sum_b) / (sum_b + 0.03) / scale, -1.0, 1.0);
    const auto byte = [](double v) { return static_cast<uint8_t>(std::lround(255.0 * std::clamp(v, 0.0, 1.0))); };
    rgba.insert(rgba.end(), {byte(0.5 + 0.5 * t), byte(0.5 - 0.5 * std::abs(t)), byte(0.5 - 0.5 * t), 255});
  }
  return rgba;
}

}  // namespace helio::bench
