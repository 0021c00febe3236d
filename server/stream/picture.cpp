#include "stream/picture.h"

#include <bit>
#include <cstring>
#include <vector>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace helio::stream {

Result<std::string> encodePng(const render::Pixels& pixels) {
  const size_t count = size_t{pixels.width} * pixels.height;
  std::vector<uint8_t> rgb(count * 3);
  for (size_t i = 0; i < count; ++i) std::memcpy(&rgb[i * 3], &pixels.rgbx[i * 4], 3);
  std::string out;
  const auto append = [](void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<size_t>(size));
  };
  const int width = static_cast<int>(pixels.width), height = static_cast<int>(pixels.height);
  if (!stbi_write_png_to_func(append, &out, width, height, 3, rgb.data(), width * 3))
    return Error{ErrorKind::internal, "PNG encoder: out of memory", {}, {}, {}};
  return out;
}

std::string encodePfm(std::span<const float> radiance, uint32_t width, uint32_t height) {
  static_assert(std::endian::native == std::endian::little);
  std::string out = "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  const size_t row = size_t{width} * 3;
  out.reserve(out.size() + radiance.size_bytes());
  for (uint32_t y = height; y-- > 0;)
    out.append(reinterpret_cast<const char*>(radiance.data() + y * row), row * sizeof(float));
  return out;
}

}  // namespace helio::stream
