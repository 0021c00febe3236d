#include "scene/gltf_accessor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <spdlog/fmt/fmt.h>

namespace helio::scene {
namespace {

constexpr std::array<unsigned char, 128> kZero{};  // an element of any type

template <typename T>
T load(const unsigned char* from) {  // accessors need not be aligned for us
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// One component as a number [glTF 2.0, 3.11: f = max(c / 127, -1) and so on].
float loadReal(const unsigned char* from, int component_type, bool normalized) {
  const auto scaled = [normalized](float value, float one) {
    return normalized ? std::max(value / one, -1.0f) : value;
  };
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return scaled(load<int8_t>(from), 127.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return scaled(load<uint8_t>(from), 255.0f);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return scaled(load<int16_t>(from), 32767.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return scaled(load<uint16_t>(from), 65535.0f);
    default:
      return load<float>(from);
  }
}

uint32_t loadIndex(const unsigned char* from, int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(from);
    default:
      return load<uint32_t>(from);
  }
}

size_t componentBytes(int component_type) {
  return static_cast<size_t>(std::max(0, tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(component_type))));
}

Error wrongType(const AccessorView& view, const std::string& wanted) {
  const std::string field = view.name + ".type";
  return invalid(field, fmt::format("{}/{}", view.type, view.component_type),
                 fmt::format("{} does not fit its use: {} are needed", view.name, wanted));
}

/// Whether the view holds floats, or integers of the allowed kind.
bool holds(const AccessorView& view, Integers allowed) {
  const int type = view.component_type;
  if (type == TINYGLTF_COMPONENT_TYPE_FLOAT) return true;
  const bool is_signed = type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT;
  const bool is_unsigned =
      type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
  switch (allowed) {
    case Integers::none:
      return false;
    case Integers::normalized_unsigned:
      return is_unsigned && view.normalized;
    case Integers::normalized_signed:
      return is_signed && view.normalized;
    case Integers::any:
      return is_signed || is_unsigned;
  }
  return false;
}

const char* describe(Integers allowed) {
  switch (allowed) {
    case Integers::none:
      return "floats";
    case Integers::normalized_unsigned:
      return "floats or of normalized unsigned bytes or shorts";
    case Integers::normalized_signed:
      return "floats or of normalized signed bytes or shorts";
    case Integers::any:
      return "floats or of bytes or shorts";
  }
  return "";
}

/// Reads the first `components` of each element.
template <typename Vector>
Result<std::vector<Vector>> readFinite(const AccessorView& view, const std::vector<uint32_t>& which,
                                       int components = Vector::length()) {
  const size_t component_bytes = componentBytes(view.component_type);
  std::vector<Vector> values(which.size(), Vector(1.0f));
  for (size_t i = 0; i < which.size(); ++i) {
    const unsigned char* element = view.element(which[i]);
    for (int c = 0; c < components; ++c) {
      const float value =
          loadReal(element + static_cast<size_t>(c) * component_bytes, view.component_type, view.normalized);
      if (!std::isfinite(value)) {
        const std::string field = fmt::format("{}[{}]", view.name, which[i]);
        return invalid(field, fmt::format("{}", value),
                       fmt::format("{} holds {}: every value must be finite", field, value));
      }
      values[i][c] = value;
    }
  }
  return values;
}

template <typename Vector>
Result<std::vector<Vector>> readVector(const AccessorView& view, const std::vector<uint32_t>& which, int type,
                                       Integers allowed) {
  if (view.type != type || !holds(view, allowed))
    return wrongType(view, fmt::format("VEC{} of {}", Vector::length(), describe(allowed)));
  return readFinite<Vector>(view, which);
}

Error wrongMember(const std::string& at, const char* member, size_t value, const std::string& why) {
  return invalid(at + "." + member, fmt::format("{}", value), fmt::format("{}.{} is {}: {}", at, member, value, why));
}

/// The first of `count` elements of `bytes` bytes each, `stride` apart, from `offset` on in a buffer view.
Result<const unsigned char*> locate(const tinygltf::Model& model, const std::string& at, int buffer_view, size_t offset,
                                    size_t bytes, size_t stride, size_t count) {
  const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(buffer_view)];
  const std::vector<unsigned char>& buffer = model.buffers[static_cast<size_t>(view.buffer)].data;
  // Differences of what was compared before, never sums or products: nothing here can wrap around.
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    return wrongMember(at, "bufferView", static_cast<size_t>(buffer_view),
                       fmt::format("this view ends past its buffer of {} bytes", buffer.size()));
  }
  if (offset > view.byteLength || bytes > view.byteLength - offset) {
    return wrongMember(at, "byteOffset", offset,
                       fmt::format("no element fits into the view's {} bytes from there on", view.byteLength));
  }
  const size_t fitting = (view.byteLength - offset - bytes) / stride + 1;
  if (count > fitting)
    return wrongMember(at, "count", count, fmt::format("its view has room for {} elements", fitting));
  return buffer.data() + view.byteOffset + offset;
}

/// Adds what a sparse accessor replaces.
Result<void> viewSparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, size_t element,
                        AccessorView& view) {
  const auto& sparse = accessor.sparse;
  const auto count = static_cast<size_t>(std::max(0, sparse.count));
  const std::string at = view.name + ".sparse";
  const size_t index_bytes = componentBytes(sparse.indices.componentType);
  const Result<const unsigned char*> indices =
      locate(model, at + ".indices", sparse.indices.bufferView, static_cast<size_t>(sparse.indices.byteOffset),
             index_bytes, index_bytes, count);
  if (!indices) return indices.error();
  const Result<const unsigned char*> values =
      locate(model, at + ".values", sparse.values.bufferView, static_cast<size_t>(sparse.values.byteOffset), element,
             element, count);
  if (!values) return values.error();

  view.replacements = *values;
  view.replacement_bytes = element;
  for (size_t i = 0; i < count; ++i) {
    const uint32_t index = loadIndex(*indices + i * index_bytes, sparse.indices.componentType);
    const auto wrong = [&](const std::string& why) {
      const std::string field = fmt::format("{}.indices[{}]", at, i);
      return invalid(field, fmt::format("{}", index), fmt::format("{} is {}: {}", field, index, why));
    };
    if (index >= accessor.count) return wrong(fmt::format("the accessor has {} elements", accessor.count));
    if (i > 0 && index <= view.replaced.back())
      return wrong(fmt::format("it must be more than the {} before it", view.replaced.back()));
    view.replaced.push_back(index);
  }
  return {};
}

}  // namespace

const unsigned char* AccessorView::element(size_t i) const {
  const auto found = std::lower_bound(replaced.begin(), replaced.end(), i);
  if (found != replaced.end() && *found == i)
    return replacements + static_cast<size_t>(found - replaced.begin()) * replacement_bytes;
  return first + i * stride;
}

Result<AccessorView> viewAccessor(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<size_t>(index)];
  const std::string name = fmt::format("accessors[{}]", index);
  const size_t component_bytes = componentBytes(accessor.componentType);
  const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
  if (component_bytes == 0 || components <= 0)
    return wrongMember(name, "componentType", static_cast<size_t>(accessor.componentType), "it is unknown");
  const size_t element = component_bytes * static_cast<size_t>(components);

  AccessorView view{kZero.data(),        accessor.count, 0,  accessor.type, accessor.componentType,
                    accessor.normalized, name,           {}, nullptr,       0};
  if (accessor.bufferView >= 0) {
    const size_t view_stride = model.bufferViews[static_cast<size_t>(accessor.bufferView)].byteStride;
    view.stride = view_stride == 0 ? element : view_stride;
    if (view.stride < element) {
      return wrongMember(name, "type", static_cast<size_t>(accessor.type),
                         fmt::format("elements of {} bytes overlap at a stride of {}", element, view.stride));
    }
    const Result<const unsigned char*> first =
        locate(model, name, accessor.bufferView, accessor.byteOffset, element, view.stride, accessor.count);
    if (!first) return first.error();
    view.first = *first;
  } else if (!accessor.sparse.isSparse) {
    return invalid(name + ".bufferView", "missing", name + ".bufferView is missing: there is nothing to read");
  }
  if (accessor.sparse.isSparse) {
    if (Result<void> done = viewSparse(model, accessor, element, view); !done) return done.error();
  }
  return view;
}

Result<std::vector<glm::vec2>> readVec2(const AccessorView& view, const std::vector<uint32_t>& which,
                                        Integers allowed) {
  return readVector<glm::vec2>(view, which, TINYGLTF_TYPE_VEC2, allowed);
}

Result<std::vector<glm::vec3>> readVec3(const AccessorView& view, const std::vector<uint32_t>& which,
                                        Integers allowed) {
  return readVector<glm::vec3>(view, which, TINYGLTF_TYPE_VEC3, allowed);
}

Result<std::vector<glm::vec4>> readVec4(const AccessorView& view, const std::vector<uint32_t>& which,
                                        Integers allowed) {
  return readVector<glm::vec4>(view, which, TINYGLTF_TYPE_VEC4, allowed);
}

Result<std::vector<glm::vec4>> readColors(const AccessorView& view, const std::vector<uint32_t>& which) {
  const bool is_rgb = view.type == TINYGLTF_TYPE_VEC3;
  if ((!is_rgb && view.type != TINYGLTF_TYPE_VEC4) || !holds(view, Integers::normalized_unsigned))
    return wrongType(view, fmt::format("VEC3 or VEC4 of {}", describe(Integers::normalized_unsigned)));
  Result<std::vector<glm::vec4>> colors = readFinite<glm::vec4>(view, which, is_rgb ? 3 : 4);
  if (!colors) return colors;
  for (glm::vec4& color : *colors) color = glm::clamp(color, 0.0f, 1.0f);
  return colors;
}

Result<std::vector<float>> readNumbers(const AccessorView& view, int type, Integers allowed) {
  if (view.type != type || !holds(view, allowed)) return wrongType(view, describe(allowed));
  // A sparse accessor without a view may claim any count: what moves has no use for it.
  if (view.stride == 0) return wrongType(view, "a buffer view's elements");
  const size_t component_bytes = componentBytes(view.component_type);
  const auto components = static_cast<size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type)));
  std::vector<float> numbers;
  numbers.reserve(view.count * components);
  for (size_t i = 0; i < view.count; ++i) {
    for (size_t c = 0; c < components; ++c) {
      const float value = loadReal(view.element(i) + c * component_bytes, view.component_type, view.normalized);
      if (!std::isfinite(value)) {
        const std::string field = fmt::format("{}[{}]", view.name, i);
        return invalid(field, fmt::format("{}", value),
                       fmt::format("{} holds {}: every value must be finite", field, value));
      }
      numbers.push_back(value);
    }
  }
  return numbers;
}

Result<std::vector<glm::u16vec4>> readJoints(const AccessorView& view, const std::vector<uint32_t>& which) {
  const int type = view.component_type;
  const bool bytes = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
  if (view.type != TINYGLTF_TYPE_VEC4 || (!bytes && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) || view.normalized)
    return wrongType(view, "VEC4 of unsigned bytes or shorts");
  std::vector<glm::u16vec4> joints;
  joints.reserve(which.size());
  for (const uint32_t vertex : which) {
    const unsigned char* element = view.element(vertex);
    glm::u16vec4 four;
    for (int c = 0; c < 4; ++c)
      four[c] = static_cast<uint16_t>(loadIndex(element + static_cast<size_t>(c) * (bytes ? 1 : 2), type));
    joints.push_back(four);
  }
  return joints;
}

Result<std::vector<uint32_t>> readIndices(const AccessorView& view, size_t vertex_count) {
  const int type = view.component_type;
  const bool is_index = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                        type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (view.type != TINYGLTF_TYPE_SCALAR || !is_index || view.normalized)
    return wrongType(view, "SCALARs of unsigned bytes, shorts or ints");
  std::vector<uint32_t> indices(view.count);
  for (size_t i = 0; i < view.count; ++i) {
    indices[i] = loadIndex(view.element(i), type);
    if (indices[i] >= vertex_count) {
      const std::string field = fmt::format("{}[{}]", view.name, i);
      return invalid(field, fmt::format("{}", indices[i]),
                     fmt::format("{} is {}: there are {} vertices", field, indices[i], vertex_count));
    }
  }
  return indices;
}

}  // namespace helio::scene
