#include "scene/gltf_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

namespace helio::scene {
namespace {

using nlohmann::json;

constexpr int kMaxNesting = 100;
constexpr std::array kSupportedExtensions = {"KHR_materials_emissive_strength"};
constexpr uint64_t kMaxImageBytes = std::numeric_limits<int>::max();  // what image decoders can be given
constexpr uint64_t kAny = uint64_t{1} << 53;                          // beyond it JSON numbers are not exact

/// The greatest number of brackets open at once, outside of strings.
int nestingOf(std::string_view text) {
  int depth = 0, deepest = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

std::string percentDecoded(const std::string& uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    const bool escaped = uri[i] == '%' && i + 2 < uri.size() &&
                         std::isxdigit(static_cast<unsigned char>(uri[i + 1])) != 0 &&
                         std::isxdigit(static_cast<unsigned char>(uri[i + 2])) != 0;
    text += escaped ? static_cast<char>(std::strtol(uri.substr(i + 1, 2).c_str(), nullptr, 16)) : uri[i];
    if (escaped) i += 2;
  }
  return text;
}

/// Relative, without a scheme and without a step upwards.
bool staysInFolder(const std::string& uri) {
  const std::string path = percentDecoded(uri);
  if (path.empty() || path[0] == '/' || path[0] == '\\' || path.find('\0') != std::string::npos) return false;
  const size_t colon = path.find(':');
  if (colon != std::string::npos && path.find('/') > colon) return false;
  for (size_t start = 0; start <= path.size();) {
    const size_t end = std::min(path.find_first_of("/\\", start), path.size());
    if (path.compare(start, end - start, "..") == 0) return false;
    start = end + 1;
  }
  return true;
}

/// Walks the document and keeps the first thing that is wrong. Checks go on after it, for they read nothing unchecked.
class Checker {
 public:
  Checker(const json& root, std::optional<uint64_t> bin_bytes) : root_(root), bin_bytes_(bin_bytes) {}

  Result<void> check() {
    checkHeader();
    for (const char* list : {"accessors", "buffers", "bufferViews", "cameras", "images", "materials", "meshes", "nodes",
                             "scenes", "textures"}) {
      checkListOfObjects(list);
    }
    if (!error_) {
      each("buffers", [this](const json& o, const std::string& at, size_t i) { checkBuffer(o, at, i); });
      each("bufferViews", [this](const json& o, const std::string& at, size_t) { checkBufferView(o, at); });
      each("accessors", [this](const json& o, const std::string& at, size_t) { checkAccessor(o, at); });
      each("meshes", [this](const json& o, const std::string& at, size_t) { checkMesh(o, at); });
      each("images", [this](const json& o, const std::string& at, size_t) { checkImage(o, at); });
      each("textures", [this](const json& o, const std::string& at, size_t) { reference(o, at, "source", "images"); });
      each("materials", [this](const json& o, const std::string& at, size_t) { checkMaterial(o, at); });
      each("nodes", [this](const json& o, const std::string& at, size_t) { checkNode(o, at); });
      each("scenes", [this](const json& o, const std::string& at, size_t) { references(o, at, "nodes", "nodes"); });
      reference(root_, "", "scene", "scenes");
    }
    if (error_) return *error_;
    return {};
  }

 private:
  void fail(ErrorKind kind, const std::string& field, std::string value, const std::string& why) {
    if (error_) return;
    if (value.size() > 60) value = value.substr(0, 57) + "...";
    error_ = Error{kind, fmt::format("{} is {}: {}", field, value, why), field, value, {}};
  }
  void fail(const std::string& field, const json& value, const std::string& why) {
    // A document from a stranger may hold anything, also text that is not UTF-8.
    fail(ErrorKind::invalid, field,
         value.is_null() ? "missing" : value.dump(-1, ' ', false, json::error_handler_t::replace), why);
  }

  static std::string join(const std::string& at, const char* key) { return at.empty() ? key : at + "." + key; }
  static const json& member(const json& object, const char* key) {
    static const json nothing;
    const auto found = object.find(key);
    return found == object.end() ? nothing : *found;
  }

  template <typename Check>
  void each(const char* list, Check&& check) {
    const json& entries = member(root_, list);
    for (size_t i = 0; i < entries.size() && !error_; ++i) check(entries[i], fmt::format("{}[{}]", list, i), i);
  }

  /// An integer in [low, high], or `fallback` when there is none.
  uint64_t integer(const json& object, const std::string& at, const char* key, std::optional<uint64_t> fallback,
                   uint64_t low, uint64_t high) {
    const json& value = member(object, key);
    if (value.is_null() && fallback) return *fallback;
    if (!value.is_number_unsigned() || value.get<uint64_t>() < low || value.get<uint64_t>() > high) {
      fail(join(at, key), value,
           high == kAny ? fmt::format("it must be an integer, {} or more", low)
                        : fmt::format("it must be an integer in [{}, {}]", low, high));
      return low;
    }
    return value.get<uint64_t>();
  }

  size_t sizeOf(const char* list) const { return member(root_, list).size(); }

  void checkIndex(const json& value, const std::string& field, const char* list) {
    if (value.is_number_unsigned() && value.get<uint64_t>() < sizeOf(list)) return;
    fail(field, value, fmt::format("it must be the index of one of {} {}", sizeOf(list), list));
  }
  void reference(const json& object, const std::string& at, const char* key, const char* list) {
    const json& value = member(object, key);
    if (!value.is_null()) checkIndex(value, join(at, key), list);
  }
  void references(const json& object, const std::string& at, const char* key, const char* list) {
    const json& values = member(object, key);
    if (values.is_null()) return;
    if (!values.is_array()) return fail(join(at, key), values, "it must be an array of indices");
    for (size_t i = 0; i < values.size() && !error_; ++i) {
      if (values[i].is_number_unsigned() && values[i].get<uint64_t>() < sizeOf(list)) continue;
      checkIndex(values[i], fmt::format("{}[{}]", join(at, key), i), list);
    }
  }

  void numbers(const json& object, const std::string& at, const char* key, size_t count) {
    const json& values = member(object, key);
    if (values.is_null()) return;
    bool good = values.is_array() && values.size() == count;
    for (size_t i = 0; good && i < count; ++i) {
      good = values[i].is_number() && std::fabs(values[i].get<double>()) <= std::numeric_limits<float>::max();
    }
    if (!good) fail(join(at, key), values, fmt::format("it must be {} finite numbers", count));
  }

  void checkListOfObjects(const char* list) {
    const json& entries = member(root_, list);
    if (entries.is_null()) return;
    if (!entries.is_array()) return fail(list, entries, "it must be an array");
    for (size_t i = 0; i < entries.size() && !error_; ++i) {
      if (!entries[i].is_object()) fail(fmt::format("{}[{}]", list, i), entries[i], "it must be an object");
    }
  }

  void checkHeader() {
    const json& asset = member(root_, "asset");
    const json& version = asset.is_object() ? member(asset, "version") : asset;
    if (!version.is_string() || version.get_ref<const std::string&>().rfind("2.", 0) != 0)
      fail("asset.version", version, "only glTF 2 can be read");

    const json& required = member(root_, "extensionsRequired");
    if (required.is_null()) return;
    if (!required.is_array()) return fail("extensionsRequired", required, "it must be an array of names");
    for (const json& name : required) {
      const auto isName = [&name](const char* supported) { return name == supported; };
      if (std::any_of(kSupportedExtensions.begin(), kSupportedExtensions.end(), isName)) continue;
      fail(ErrorKind::unsupported, "extensionsRequired", name.dump(-1, ' ', false, json::error_handler_t::replace),
           fmt::format("this extension is not supported, export the model without it (supported: {})",
                       fmt::join(kSupportedExtensions, ", ")));
    }
  }

  void checkUri(const json& uri, const std::string& field) {
    if (!uri.is_string()) return fail(field, uri, "it must be text");
    const std::string& text = uri.get_ref<const std::string&>();
    if (text.rfind("data:", 0) == 0 || staysInFolder(text)) return;
    fail(field, uri, "it must be a data URI or name a file in the model's folder or below");
  }

  void checkBuffer(const json& buffer, const std::string& at, size_t index) {
    const uint64_t bytes = integer(buffer, at, "byteLength", std::nullopt, 1, kAny);
    const json& uri = member(buffer, "uri");
    if (!uri.is_null()) return checkUri(uri, at + ".uri");
    if (!bin_bytes_) return fail(at + ".uri", uri, "a buffer of a .gltf file needs one");
    if (index != 0) return fail(at + ".uri", uri, "only the first buffer may use the GLB's binary chunk");
    if (bytes > *bin_bytes_) {
      fail(at + ".byteLength", member(buffer, "byteLength"),
           fmt::format("the GLB's binary chunk holds {} bytes", *bin_bytes_));
    }
  }

  void checkBufferView(const json& view, const std::string& at) {
    const json& buffer = member(view, "buffer");
    checkIndex(buffer, at + ".buffer", "buffers");
    const uint64_t offset = integer(view, at, "byteOffset", 0, 0, kAny);
    const uint64_t length = integer(view, at, "byteLength", std::nullopt, 1, kAny);
    const uint64_t stride = integer(view, at, "byteStride", 4, 4, 252);
    if (stride % 4 != 0) fail(at + ".byteStride", member(view, "byteStride"), "it must be a multiple of 4");
    if (error_) return;
    const uint64_t held = root_["buffers"][buffer.get<size_t>()]["byteLength"].get<uint64_t>();
    if (offset > held)
      return fail(at + ".byteOffset", view["byteOffset"], fmt::format("its buffer holds {} bytes", held));
    if (length > held - offset) {
      fail(at + ".byteLength", view["byteLength"],
           fmt::format("its buffer holds {} bytes from byteOffset {} on", held - offset, offset));
    }
  }

  void checkAccessor(const json& accessor, const std::string& at) {
    reference(accessor, at, "bufferView", "bufferViews");
    integer(accessor, at, "byteOffset", 0, 0, kAny);
    integer(accessor, at, "count", std::nullopt, 1, kAny);
    const uint64_t component = integer(accessor, at, "componentType", std::nullopt, 5120, 5126);
    if (component == 5124)
      fail(at + ".componentType", member(accessor, "componentType"), "glTF has no such component type");
    if (!member(accessor, "type").is_string())
      fail(at + ".type", member(accessor, "type"), "it must be text such as \"VEC3\"");
  }

  void checkMesh(const json& mesh, const std::string& at) {
    const json& primitives = member(mesh, "primitives");
    if (!primitives.is_array() || primitives.empty())
      return fail(at + ".primitives", primitives, "it must be an array that is not empty");
    for (size_t i = 0; i < primitives.size() && !error_; ++i) {
      const json& primitive = primitives[i];
      const std::string here = fmt::format("{}.primitives[{}]", at, i);
      if (!primitive.is_object()) return fail(here, primitive, "it must be an object");
      const json& attributes = member(primitive, "attributes");
      if (!attributes.is_object()) return fail(here + ".attributes", attributes, "it must be an object");
      for (const auto& [name, accessor] : attributes.items())
        checkIndex(accessor, here + ".attributes." + name, "accessors");
      reference(primitive, here, "indices", "accessors");
      reference(primitive, here, "material", "materials");
      integer(primitive, here, "mode", 4, 0, 6);
    }
  }

  void checkImage(const json& image, const std::string& at) {
    const json& uri = member(image, "uri");
    const json& view = member(image, "bufferView");
    if (uri.is_null() == view.is_null()) return fail(at, image, "it must have either a uri or a bufferView");
    if (!uri.is_null()) return checkUri(uri, at + ".uri");
    checkIndex(view, at + ".bufferView", "bufferViews");
    if (error_) return;
    const json& bytes = root_["bufferViews"][view.get<size_t>()]["byteLength"];
    if (bytes.get<uint64_t>() > kMaxImageBytes)
      fail(at + ".bufferView", view, fmt::format("its {} bytes are too many for an image", bytes.dump()));
  }

  void checkTextureInfo(const json& owner, const std::string& at, const char* key) {
    const json& info = member(owner, key);
    if (info.is_null()) return;
    if (!info.is_object()) return fail(join(at, key), info, "it must be an object");
    checkIndex(member(info, "index"), join(at, key) + ".index", "textures");
  }

  void checkMaterial(const json& material, const std::string& at) {
    checkTextureInfo(material, at, "normalTexture");
    checkTextureInfo(material, at, "emissiveTexture");
    numbers(material, at, "emissiveFactor", 3);
    const json& pbr = member(material, "pbrMetallicRoughness");
    if (pbr.is_null()) return;
    const std::string here = at + ".pbrMetallicRoughness";
    if (!pbr.is_object()) return fail(here, pbr, "it must be an object");
    checkTextureInfo(pbr, here, "baseColorTexture");
    checkTextureInfo(pbr, here, "metallicRoughnessTexture");
    numbers(pbr, here, "baseColorFactor", 4);
  }

  void checkNode(const json& node, const std::string& at) {
    reference(node, at, "mesh", "meshes");
    reference(node, at, "camera", "cameras");
    references(node, at, "children", "nodes");
    numbers(node, at, "matrix", 16);
    numbers(node, at, "translation", 3);
    numbers(node, at, "rotation", 4);
    numbers(node, at, "scale", 3);
  }

  const json& root_;
  const std::optional<uint64_t> bin_bytes_;
  std::optional<Error> error_;
};

}  // namespace

Result<void> checkDocument(std::string_view json_text, std::optional<uint64_t> bin_bytes) {
  // tinygltf walks `extras` by recursion: what is nested without bound would end on the stack's end.
  if (nestingOf(json_text) > kMaxNesting) {
    return Error{ErrorKind::limit, fmt::format("its JSON is nested more than {} levels deep", kMaxNesting), "", "",
                 fmt::format("{}", kMaxNesting)};
  }
  json root;
  try {
    root = json::parse(json_text);
  } catch (const json::exception& problem) {
    return invalid("", "", fmt::format("its JSON cannot be read: {}", problem.what()));
  }
  if (!root.is_object()) return invalid("", "", "its JSON must be an object");
  return Checker(root, bin_bytes).check();
}

}  // namespace helio::scene
