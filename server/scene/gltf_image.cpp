#include "scene/gltf_image.h"

#include <cstring>
#include <limits>
#include <memory>
#include <string_view>

#include <spdlog/fmt/fmt.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC  // no symbols that another user of the library could meet
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace helio::scene {
namespace {

/// The size that the header states. The decoder's own look at a header refuses large images as if they were none, so
/// PNG's, which has a fixed place, is read here.
bool readSize(std::span<const unsigned char> encoded, uint32_t& width, uint32_t& height) {
  constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n";
  constexpr size_t kWidth = 16, kHeight = 20, kHeaderEnd = 24;
  const auto bigEndian = [&](size_t at) {
    return uint32_t{encoded[at]} << 24 | uint32_t{encoded[at + 1]} << 16 | uint32_t{encoded[at + 2]} << 8 |
           encoded[at + 3];
  };
  if (encoded.size() >= kHeaderEnd && std::memcmp(encoded.data(), kPng.data(), kPng.size()) == 0) {
    width = bigEndian(kWidth);
    height = bigEndian(kHeight);
  } else {
    int w = 0, h = 0, channels = 0;
    if (stbi_info_from_memory(encoded.data(), static_cast<int>(encoded.size()), &w, &h, &channels) == 0) return false;
    width = static_cast<uint32_t>(w);
    height = static_cast<uint32_t>(h);
  }
  return width > 0 && height > 0;
}

}  // namespace

Result<void> decodeImage(std::span<const unsigned char> encoded, uint32_t max_edge, uint64_t& bytes_left,
                         Texture& texture) {
  constexpr int kChannels = 4;
  if (encoded.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
    return invalid("", "", "it is too large to decode");
  const int size = static_cast<int>(encoded.size());

  uint32_t w = 0, h = 0;
  if (!readSize(encoded, w, h)) return invalid("", "", "it is no PNG or JPEG that can be read");
  const std::string edges = fmt::format("{} x {}", w, h);
  if (w > max_edge || h > max_edge) {
    return Error{ErrorKind::limit, fmt::format("it has {} texels, at most {} a side are allowed", edges, max_edge), "",
                 edges, fmt::format("{}", max_edge)};
  }
  const uint64_t bytes = uint64_t{w} * h * kChannels;
  if (bytes > bytes_left) {
    return Error{ErrorKind::limit,
                 fmt::format("its {} texels need {} bytes, and of what all textures may take {} are left", edges, bytes,
                             bytes_left),
                 "", fmt::format("{}", bytes), fmt::format("{}", bytes_left)};
  }

  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, void (*)(void*)> texels(
      stbi_load_from_memory(encoded.data(), size, &width, &height, &channels, kChannels), stbi_image_free);
  if (!texels || static_cast<uint32_t>(width) != w || static_cast<uint32_t>(height) != h) {
    return invalid("", "", fmt::format("it is damaged ({})", texels ? "its size changes" : stbi_failure_reason()));
  }
  bytes_left -= bytes;
  texture.width = w;
  texture.height = h;
  texture.rgba.assign(texels.get(), texels.get() + bytes);
  return {};
}

}  // namespace helio::scene
