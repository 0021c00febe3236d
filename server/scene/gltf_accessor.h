// Reading accessors: every one is checked against its views and buffers before its first byte is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "base/result.h"
#include "scene/gltf_model.h"

namespace helio::scene {

/// `count` elements that lie within their buffers. A sparse accessor takes some of them from elsewhere; of one without
/// a buffer view all others are zero, and `count` is bounded by nothing.
struct AccessorView {
  const unsigned char* first = nullptr;
  size_t count = 0;
  size_t stride = 0;       ///< bytes from element to element; 0: all are the same
  int type = 0;            ///< TINYGLTF_TYPE_...
  int component_type = 0;  ///< TINYGLTF_COMPONENT_TYPE_...
  bool normalized = false;
  std::string name;  ///< "accessors[3]", for errors

  std::vector<uint32_t> replaced;               ///< sparse: the elements with values of their own, in rising order
  const unsigned char* replacements = nullptr;  ///< their values, tightly packed
  size_t replacement_bytes = 0;                 ///< of one value

  const unsigned char* element(size_t i) const;  ///< i < count
};

/// Errors (invalid, naming the accessor): neither a buffer view nor sparse, an element past the end of its view or of
/// the buffer, sparse indices that do not rise or name no element.
Result<AccessorView> viewAccessor(const tinygltf::Model& model, int accessor);

/// The numbers beside floats that an attribute may hold. Normalized integers map to [0, 1] or [-1, 1].
enum class Integers {
  none,
  normalized_unsigned,  ///< 8 and 16 bits: texture coordinates and colours
  normalized_signed,    ///< 8 and 16 bits: rotations, and with KHR_mesh_quantization normals and tangents
  any,                  ///< of 8 and 16 bits: with KHR_mesh_quantization positions and texture coordinates
};

/// The elements that `which` names, all less than view.count. Errors (invalid): another type than the use allows, a
/// value that is not finite.
Result<std::vector<glm::vec2>> readVec2(const AccessorView& view, const std::vector<uint32_t>& which, Integers allowed);
Result<std::vector<glm::vec3>> readVec3(const AccessorView& view, const std::vector<uint32_t>& which, Integers allowed);
Result<std::vector<glm::vec4>> readVec4(const AccessorView& view, const std::vector<uint32_t>& which, Integers allowed);
/// VEC3 or VEC4, of floats or normalized unsigned integers; clamped to [0, 1], alpha 1 where there is none.
Result<std::vector<glm::vec4>> readColors(const AccessorView& view, const std::vector<uint32_t>& which);

/// All numbers of an accessor of floats (or normalized integers, where they are allowed) and of TINYGLTF_TYPE_...
/// `type`, one behind the other. Errors (invalid): another type, a value that is not finite, an accessor whose size
/// nothing in the file bounds.
Result<std::vector<float>> readNumbers(const AccessorView& view, int type, Integers allowed);

/// Four joint indices a vertex, of unsigned bytes or shorts.
Result<std::vector<glm::u16vec4>> readJoints(const AccessorView& view, const std::vector<uint32_t>& which);

/// All elements of an accessor of unsigned 8, 16 or 32 bit scalars. Errors (invalid): another type, a value that is not
/// less than `vertex_count`.
Result<std::vector<uint32_t>> readIndices(const AccessorView& view, size_t vertex_count);

}  // namespace helio::scene
