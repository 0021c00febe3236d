// PNG and JPEG to RGBA, with the size looked at before anything is decoded.
#pragma once

#include <cstdint>
#include <span>

#include "base/result.h"
#include "scene/scene.h"

namespace helio::scene {

/// Decodes an image into texture.width, height and rgba (8 bits a channel, 16 are reduced). `bytes_left` is what all
/// textures together may still take; the texture's bytes are subtracted. Errors without the image's name: limit (edge
/// or bytes_left, told by the header alone), invalid (no PNG or JPEG, damaged).
Result<void> decodeImage(std::span<const unsigned char> encoded, uint32_t max_edge, uint64_t& bytes_left,
                         Texture& texture);

}  // namespace helio::scene
