#include "scene/gltf_accessor.h"

#include <cmath>
#include <cstring>

#include <spdlog/fmt/fmt.h>

namespace helio::scene {
namespace {

template <typename T>
T load(const unsigned char* from) {  // accessors need not be aligned for us
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// One component as a number. Normalized integers map to [0, 1].
float loadReal(const unsigned char* from, int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(from) / 255.0f;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(from) / 65535.0f;
    default:
      return load<float>(from);
  }
}

Error wrongType(const AccessorView& view, const char* wanted) {
  const std::string field = view.name + ".type";
  return invalid(field, fmt::format("{}/{}", view.type, view.component_type),
                 fmt::format("{} does not fit its use: {} are needed", view.name, wanted));
}

template <typename Vector>
Result<std::vector<Vector>> readFinite(const AccessorView& view, const std::vector<uint32_t>& which) {
  const auto component_bytes =
      static_cast<size_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(view.component_type)));
  std::vector<Vector> values(which.size());
  for (size_t i = 0; i < which.size(); ++i) {
    const unsigned char* element = view.first + which[i] * view.stride;
    for (int c = 0; c < Vector::length(); ++c) {
      const float value = loadReal(element + static_cast<size_t>(c) * component_bytes, view.component_type);
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

}  // namespace

Result<AccessorView> viewAccessor(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors[static_cast<size_t>(index)];
  const std::string name = fmt::format("accessors[{}]", index);
  if (accessor.sparse.isSparse)
    return Error{ErrorKind::unsupported, name + " is sparse: sparse accessors are not supported", name, "sparse", {}};
  if (accessor.bufferView < 0)
    return invalid(name + ".bufferView", "missing", name + ".bufferView is missing: there is nothing to read");
  const tinygltf::BufferView& view = model.bufferViews[static_cast<size_t>(accessor.bufferView)];
  const std::vector<unsigned char>& buffer = model.buffers[static_cast<size_t>(view.buffer)].data;

  // Differences of what was compared before, never sums or products: nothing here can wrap around.
  const auto pastTheEnd = [&](const char* member, size_t value, const std::string& why) {
    return invalid(name + "." + member, fmt::format("{}", value),
                   fmt::format("{}.{} is {}: {}", name, member, value, why));
  };
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    return pastTheEnd("bufferView", static_cast<size_t>(accessor.bufferView),
                      fmt::format("this view ends past its buffer of {} bytes", buffer.size()));
  }
  const int component_bytes = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(accessor.componentType));
  const int components = tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type));
  if (component_bytes <= 0 || components <= 0)
    return pastTheEnd("componentType", static_cast<size_t>(accessor.componentType), "it is unknown");
  const size_t element = static_cast<size_t>(component_bytes) * static_cast<size_t>(components);
  const size_t stride = view.byteStride == 0 ? element : view.byteStride;
  if (stride < element)
    return pastTheEnd("type", static_cast<size_t>(accessor.type),
                      fmt::format("elements of {} bytes overlap at a stride of {}", element, stride));
  if (accessor.byteOffset > view.byteLength || element > view.byteLength - accessor.byteOffset) {
    return pastTheEnd("byteOffset", accessor.byteOffset,
                      fmt::format("no element fits into the view's {} bytes from there on", view.byteLength));
  }
  const size_t fitting = (view.byteLength - accessor.byteOffset - element) / stride + 1;
  if (accessor.count > fitting)
    return pastTheEnd("count", accessor.count, fmt::format("its view has room for {} elements", fitting));

  return AccessorView{buffer.data() + view.byteOffset + accessor.byteOffset,
                      accessor.count,
                      stride,
                      accessor.type,
                      accessor.componentType,
                      accessor.normalized,
                      name};
}

Result<std::vector<glm::vec2>> readUvs(const AccessorView& view, const std::vector<uint32_t>& which) {
  const bool normalized_integers = view.normalized && (view.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                                       view.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  if (view.type != TINYGLTF_TYPE_VEC2 ||
      (view.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT && !normalized_integers)) {
    return wrongType(view, "VEC2 of floats or of normalized unsigned bytes or shorts");
  }
  return readFinite<glm::vec2>(view, which);
}

Result<std::vector<glm::vec3>> readVectors(const AccessorView& view, const std::vector<uint32_t>& which) {
  if (view.type != TINYGLTF_TYPE_VEC3 || view.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT)
    return wrongType(view, "VEC3 of floats");
  return readFinite<glm::vec3>(view, which);
}

Result<std::vector<glm::vec4>> readTangents(const AccessorView& view, const std::vector<uint32_t>& which) {
  if (view.type != TINYGLTF_TYPE_VEC4 || view.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT)
    return wrongType(view, "VEC4 of floats");
  return readFinite<glm::vec4>(view, which);
}

Result<std::vector<uint32_t>> readIndices(const AccessorView& view, size_t vertex_count) {
  const int type = view.component_type;
  const bool is_index = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                        type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  if (view.type != TINYGLTF_TYPE_SCALAR || !is_index || view.normalized)
    return wrongType(view, "SCALARs of unsigned bytes, shorts or ints");
  std::vector<uint32_t> indices(view.count);
  for (size_t i = 0; i < view.count; ++i) {
    const unsigned char* element = view.first + i * view.stride;
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) {
      indices[i] = load<uint8_t>(element);
    } else if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
      indices[i] = load<uint16_t>(element);
    } else {
      indices[i] = load<uint32_t>(element);
    }
    if (indices[i] >= vertex_count) {
      const std::string field = fmt::format("{}[{}]", view.name, i);
      return invalid(field, fmt::format("{}", indices[i]),
                     fmt::format("{} is {}: there are {} vertices", field, indices[i], vertex_count));
    }
  }
  return indices;
}

}  // namespace helio::scene
