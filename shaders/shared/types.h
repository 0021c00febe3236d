// Read by C++ and by GLSL: the words that let both say the same struct. All structs use scalar layout: a member is
// aligned to its component's size, so a vec3 takes 12 bytes and the C++ struct has the same bytes.
#ifndef HELIO_SHARED_TYPES_H
#define HELIO_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace helio::shared {
using uint = uint32_t;
using glm::uvec2;
using glm::vec2;
using glm::vec3;
using glm::vec4;
}  // namespace helio::shared
#define HELIO_SHARED_BEGIN namespace helio::shared {
#define HELIO_SHARED_END }
#define HELIO_CONSTANT static constexpr uint
#else
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference2 : require
#define HELIO_SHARED_BEGIN
#define HELIO_SHARED_END
#define HELIO_CONSTANT const uint
#endif

#endif
