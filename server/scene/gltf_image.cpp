#include "scene/gltf_image.h"

#include <limits>
#include <memory>

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

Result<void> decodeImage(std::span<const unsigned char> encoded, uint32_t max_edge, uint64_t& bytes_left,
                         Texture& texture) {
  constexpr int kChannels = 4;
  if (encoded.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
    return invalid("", "", "it is too large to decode");
  const int size = static_cast<int>(encoded.size());

  int width = 0, height = 0, channels = 0;
  if (stbi_info_from_memory(encoded.data(), size, &width, &height, &channels) == 0 || width <= 0 || height <= 0) {
    const std::string reason = stbi_failure_reason();
    if (reason == "too large") {  // the decoder's own limit, which it applies before ours can be
      return Error{ErrorKind::limit,
                   fmt::format("it is larger than any image that can be decoded, at most {} texels a side are allowed",
                               max_edge),
                   "", "", fmt::format("{}", max_edge)};
    }
    return invalid("", "", fmt::format("it is no PNG or JPEG that can be read ({})", reason));
  }
  const auto w = static_cast<uint32_t>(width), h = static_cast<uint32_t>(height);
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
