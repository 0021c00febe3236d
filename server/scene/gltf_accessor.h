// Reading accessors: every one is checked against its view and buffer before its first byte is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/result.h"
#include "scene/gltf_model.h"

namespace helio::scene {

/// `count` elements that lie within their buffer.
struct AccessorView {
  const unsigned char* first = nullptr;
  size_t count = 0;
  size_t stride = 0;       ///< bytes from element to element
  int type = 0;            ///< TINYGLTF_TYPE_...
  int component_type = 0;  ///< TINYGLTF_COMPONENT_TYPE_...
  bool normalized = false;
  std::string name;  ///< "accessors[3]", for errors
};

/// Errors (invalid, naming the accessor): no buffer view, sparse, an element past the end of the view or of the buffer.
Result<AccessorView> viewAccessor(const tinygltf::Model& model, int accessor);

/// The elements that `which` names, all less than view.count. Floats must be finite; 8 and 16 bit integers of texture
/// coordinates must be normalized. Errors (invalid): another type than glTF allows for this use, a value that is not
/// finite.
Result<std::vector<glm::vec2>> readUvs(const AccessorView& view, const std::vector<uint32_t>& which);
Result<std::vector<glm::vec3>> readVectors(const AccessorView& view, const std::vector<uint32_t>& which);
Result<std::vector<glm::vec4>> readTangents(const AccessorView& view, const std::vector<uint32_t>& which);

/// All elements of an accessor of unsigned 8, 16 or 32 bit scalars. Errors (invalid): another type, a value that is not
/// less than `vertex_count`.
Result<std::vector<uint32_t>> readIndices(const AccessorView& view, size_t vertex_count);

}  // namespace helio::scene
