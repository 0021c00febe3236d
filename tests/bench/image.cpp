#include "bench/image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numeric>

#include "bench/files.h"
#include "stream/picture.h"

namespace helio::bench {
namespace {

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

Result<void> writePictures(const std::string& folder, const std::string& name, const Image& image, const Image& truth) {
  std::error_code ignored;  // what cannot be made cannot be written to
  std::filesystem::create_directories(folder, ignored);
  const auto write = [&](const std::string& file, const std::vector<uint8_t>& rgbx) -> Result<void> {
    const auto png = stream::encodePng({rgbx.data(), image.width, image.height});
    if (!png) return png.error();
    return writeFile(folder + "/" + file, *png);
  };
  if (auto written = write(name + ".png", tonemapped(image, truth)); !written) return written;
  return write(name + ".error.png", differencePicture(image, truth, 0.1));
}

}  // namespace helio::bench
