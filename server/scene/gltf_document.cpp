#include "scene/gltf_document.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <string>

#include "scene/gltf_checker.h"
#include "scene/gltf_extensions.h"

namespace helio::scene {
namespace {

using nlohmann::json;

constexpr int kMaxNesting = 100;
constexpr uint64_t kMaxImageBytes = std::numeric_limits<int>::max();  // what image decoders can be given
constexpr size_t kMaxJoints = 1024;                                   // of a skin: far more than any body has
constexpr uint64_t kMaxInteger = std::numeric_limits<int>::max();  // what tinygltf keeps offsets of sparse accessors in

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

class DocumentChecker : GltfChecker {
 public:
  DocumentChecker(const json& root, std::optional<uint64_t> bin_bytes) : GltfChecker(root), bin_bytes_(bin_bytes) {}

  Result<void> check() {
    checkHeader();
    for (const char* list : {"accessors", "animations", "buffers", "bufferViews", "cameras", "images", "materials",
                             "meshes", "nodes", "samplers", "scenes", "skins", "textures"}) {
      listOfObjects(root(), "", list);
    }
    if (!error()) {
      each("buffers", [this](const json& o, const std::string& at, size_t i) { checkBuffer(o, at, i); });
      each("bufferViews", [this](const json& o, const std::string& at, size_t) { checkBufferView(o, at); });
      each("accessors", [this](const json& o, const std::string& at, size_t) { checkAccessor(o, at); });
      each("meshes", [this](const json& o, const std::string& at, size_t) { checkMesh(o, at); });
      each("images", [this](const json& o, const std::string& at, size_t) { checkImage(o, at); });
      each("textures", [this](const json& o, const std::string& at, size_t) {
        reference(o, at, "source", "images");
        reference(o, at, "sampler", "samplers");
      });
      each("materials", [this](const json& o, const std::string& at, size_t) { checkMaterial(o, at); });
      checkLights(*this);
      each("skins", [this](const json& o, const std::string& at, size_t) { checkSkin(o, at); });
      each("animations", [this](const json& o, const std::string& at, size_t) { checkAnimation(o, at); });
      each("nodes", [this](const json& o, const std::string& at, size_t) { checkNode(o, at); });
      each("scenes", [this](const json& o, const std::string& at, size_t) { references(o, at, "nodes", "nodes"); });
      reference(root(), "", "scene", "scenes");
    }
    if (error()) return *error();
    return {};
  }

 private:
  void checkHeader() {
    const json& asset = member(root(), "asset");
    const json& version = asset.is_object() ? member(asset, "version") : asset;
    if (!version.is_string() || version.get_ref<const std::string&>().rfind("2.", 0) != 0)
      fail("asset.version", version, "only glTF 2 can be read");

    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      const json& names = member(root(), list);
      const auto isText = [](const json& name) { return name.is_string(); };
      if (!names.is_null() && (!names.is_array() || !std::all_of(names.begin(), names.end(), isText)))
        return fail(list, names, "it must be an array of names");
    }
    for (const json& name : member(root(), "extensionsRequired")) {
      if (isSupportedExtension(name.get_ref<const std::string&>())) continue;
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
    index(buffer, at + ".buffer", "buffers");
    const uint64_t offset = integer(view, at, "byteOffset", 0, 0, kAny);
    const uint64_t length = integer(view, at, "byteLength", std::nullopt, 1, kAny);
    const uint64_t stride = integer(view, at, "byteStride", 4, 4, 252);
    if (stride % 4 != 0) fail(at + ".byteStride", member(view, "byteStride"), "it must be a multiple of 4");
    if (error()) return;
    const uint64_t held = root()["buffers"][buffer.get<size_t>()]["byteLength"].get<uint64_t>();
    if (offset > held)
      return fail(at + ".byteOffset", view["byteOffset"], fmt::format("its buffer holds {} bytes", held));
    if (length > held - offset) {
      fail(at + ".byteLength", view["byteLength"],
           fmt::format("its buffer holds {} bytes from byteOffset {} on", held - offset, offset));
    }
  }

  uint64_t checkComponentType(const json& owner, const std::string& at) {
    const uint64_t component = integer(owner, at, "componentType", std::nullopt, 5120, 5126);
    if (component == 5124)
      fail(at + ".componentType", member(owner, "componentType"), "glTF has no such component type");
    return component;
  }

  void checkAccessor(const json& accessor, const std::string& at) {
    reference(accessor, at, "bufferView", "bufferViews");
    integer(accessor, at, "byteOffset", 0, 0, kAny);
    const uint64_t count = integer(accessor, at, "count", std::nullopt, 1, kAny);
    checkComponentType(accessor, at);
    if (!member(accessor, "type").is_string())
      fail(at + ".type", member(accessor, "type"), "it must be text such as \"VEC3\"");

    const json& sparse = object(accessor, at, "sparse");
    if (sparse.is_null()) return;
    integer(sparse, at + ".sparse", "count", std::nullopt, 1, std::min(count, kMaxInteger));
    for (const char* part : {"indices", "values"}) {
      const std::string here = at + ".sparse." + part;
      const json& source = object(sparse, at + ".sparse", part);
      index(member(source, "bufferView"), here + ".bufferView", "bufferViews");
      integer(source, here, "byteOffset", 0, 0, kMaxInteger);
    }
    const std::string indices = at + ".sparse.indices";
    const uint64_t component = checkComponentType(member(sparse, "indices"), indices);
    if (component != 5121 && component != 5123 && component != 5125) {
      fail(indices + ".componentType", member(member(sparse, "indices"), "componentType"),
           "it must be 5121, 5123 or 5125: unsigned bytes, shorts or ints");
    }
  }

  void checkMesh(const json& mesh, const std::string& at) {
    if (has(mesh, "weights")) numbers(mesh, at, "weights", member(mesh, "weights").size());
    const json& primitives = member(mesh, "primitives");
    if (!primitives.is_array() || primitives.empty())
      return fail(at + ".primitives", primitives, "it must be an array that is not empty");
    for (size_t i = 0; i < primitives.size() && !error(); ++i) {
      const json& primitive = primitives[i];
      const std::string here = fmt::format("{}.primitives[{}]", at, i);
      if (!primitive.is_object()) return fail(here, primitive, "it must be an object");
      const json& attributes = member(primitive, "attributes");
      if (!attributes.is_object()) return fail(here + ".attributes", attributes, "it must be an object");
      for (const auto& [name, accessor] : attributes.items())
        index(accessor, fmt::format("{}.attributes.{}", here, name), "accessors");
      listOfObjects(primitive, here, "targets");
      const json& targets = member(primitive, "targets");
      for (size_t t = 0; t < targets.size() && !error(); ++t) {
        for (const auto& [name, accessor] : targets[t].items())
          index(accessor, fmt::format("{}.targets[{}].{}", here, t, name), "accessors");
      }
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
    index(view, at + ".bufferView", "bufferViews");
    if (error()) return;
    const json& bytes = root()["bufferViews"][view.get<size_t>()]["byteLength"];
    if (bytes.get<uint64_t>() > kMaxImageBytes)
      fail(at + ".bufferView", view, fmt::format("its {} bytes are too many for an image", bytes.dump()));
  }

  void checkMaterial(const json& material, const std::string& at) {
    for (const char* key : {"normalTexture", "emissiveTexture", "occlusionTexture"})
      checkTextureInfo(*this, material, at, key);
    numbers(material, at, "emissiveFactor", 3);
    const json& pbr = object(material, at, "pbrMetallicRoughness");
    const std::string here = at + ".pbrMetallicRoughness";
    checkTextureInfo(*this, pbr, here, "baseColorTexture");
    checkTextureInfo(*this, pbr, here, "metallicRoughnessTexture");
    numbers(pbr, here, "baseColorFactor", 4);
    checkMaterialExtensions(*this, material, at);
  }

  void checkSkin(const json& skin, const std::string& at) {
    const json& joints = member(skin, "joints");
    if (!joints.is_array() || joints.empty() || joints.size() > kMaxJoints)
      return fail(at + ".joints", joints, fmt::format("it must be an array of 1 to {} nodes", kMaxJoints));
    references(skin, at, "joints", "nodes");
    reference(skin, at, "skeleton", "nodes");
    reference(skin, at, "inverseBindMatrices", "accessors");
  }

  void checkAnimation(const json& animation, const std::string& at) {
    listOfObjects(animation, at, "samplers");
    listOfObjects(animation, at, "channels");
    if (error()) return;
    const json& samplers = member(animation, "samplers");
    for (size_t i = 0; i < samplers.size() && !error(); ++i) {
      const std::string here = fmt::format("{}.samplers[{}]", at, i);
      index(member(samplers[i], "input"), here + ".input", "accessors");
      index(member(samplers[i], "output"), here + ".output", "accessors");
      const json& kind = member(samplers[i], "interpolation");
      if (kind.is_null() || kind == "LINEAR" || kind == "STEP" || kind == "CUBICSPLINE") continue;
      fail(here + ".interpolation", kind, "it must be LINEAR, STEP or CUBICSPLINE");
    }
    const json& channels = member(animation, "channels");
    for (size_t i = 0; i < channels.size() && !error(); ++i) {
      const std::string here = fmt::format("{}.channels[{}]", at, i);
      const json& sampler = member(channels[i], "sampler");
      if (!sampler.is_number_unsigned() || sampler.get<uint64_t>() >= samplers.size())
        return fail(here + ".sampler", sampler,
                    fmt::format("it must be the index of one of {} samplers", samplers.size()));
      const json& target = object(channels[i], here, "target");
      reference(target, here + ".target", "node", "nodes");
      if (!member(target, "path").is_string())
        fail(here + ".target.path", member(target, "path"), "it must be text such as \"rotation\"");
    }
  }

  void checkNode(const json& node, const std::string& at) {
    reference(node, at, "mesh", "meshes");
    reference(node, at, "skin", "skins");
    if (has(node, "weights")) numbers(node, at, "weights", member(node, "weights").size());
    reference(node, at, "camera", "cameras");
    references(node, at, "children", "nodes");
    numbers(node, at, "matrix", 16);
    numbers(node, at, "translation", 3);
    numbers(node, at, "rotation", 4);
    numbers(node, at, "scale", 3);
    checkNodeExtensions(*this, node, at);
  }

  const std::optional<uint64_t> bin_bytes_;
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
  return DocumentChecker(root, bin_bytes).check();
}

}  // namespace helio::scene
