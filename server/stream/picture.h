// Still pictures as files: PNG and portable float map.
#pragma once

#include <span>
#include <string>

#include "base/result.h"
#include "render/renderer.h"

namespace helio::stream {

/// 8-bit RGB PNG. Errors: out of memory (internal).
Result<std::string> encodePng(const render::Pixels& pixels);

/// Colour PFM, little-endian, rows bottom-up as the format wants. `radiance`: width * height * 3, rows top-down.
std::string encodePfm(std::span<const float> radiance, uint32_t width, uint32_t height);

}  // namespace helio::stream
