// The SPIR-V modules of shaders/, compiled at build time and embedded in the program.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace helio::shaders {

// The words of the module compiled from shaders/<name>, e.g. find("path_trace/path_trace.rgen"); they live as long as
// the program. Empty when there is no such shader.
std::span<const std::uint32_t> find(std::string_view name);

}  // namespace helio::shaders
