// The checks of a glTF document's JSON that come before tinygltf sees it: tinygltf leaves much of it to its users.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "base/result.h"

namespace helio::scene {

/// Checks nesting, version, required extensions, the type and range of every integer and transform, every reference
/// from one array into another, buffer views against their buffers, and that URIs stay in the file's folder.
/// `bin_bytes` is the size of a GLB's binary chunk, 0 when it has none; nothing for a .gltf file. Errors: invalid with
/// the place
/// ("bufferViews[2].byteLength"), unsupported with the required extension, limit.
Result<void> checkDocument(std::string_view json_text, std::optional<uint64_t> bin_bytes);

}  // namespace helio::scene
