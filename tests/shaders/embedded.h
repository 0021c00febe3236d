// The SPIR-V modules of tests/shaders, compiled at build time and embedded in the test programs.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace helio::test::shaders {

// The words of the module compiled from tests/shaders/<name>, e.g. find("random.comp"); they live as long as the
// program. Empty when there is no such shader.
std::span<const std::uint32_t> find(std::string_view name);

}  // namespace helio::test::shaders
