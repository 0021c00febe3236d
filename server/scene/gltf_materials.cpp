#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "scene/gltf_image.h"
#include "scene/gltf_import.h"

namespace helio::scene {
namespace {

constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";

class MaterialImporter {
 public:
  MaterialImporter(const tinygltf::Model& model, const GltfOptions& options, Scene& scene)
      : model_(model), options_(options), scene_(scene), bytes_left_(options.max_texture_bytes) {}

  Result<void> import() {
    for (size_t i = 0; i < model_.materials.size(); ++i) {
      Result<Material> material = importMaterial(model_.materials[i], fmt::format("materials[{}]", i));
      if (!material) return material.error();
      scene_.materials.push_back(std::move(*material));
    }
    Material none;  // what the specification gives to primitives without a material
    none.name = "default";
    none.metallic = options_.lambert ? 0.0f : 1.0f;
    none.lambert = options_.lambert;
    scene_.materials.push_back(std::move(none));
    return {};
  }

 private:
  Result<Material> importMaterial(const tinygltf::Material& from, const std::string& at) {
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    Material material;
    material.name = from.name;
    material.lambert = options_.lambert;
    for (int c = 0; c < 4; ++c) material.base_color[c] = unit(pbr.baseColorFactor[static_cast<size_t>(c)]);
    for (int c = 0; c < 3; ++c) material.emission[c] = unit(from.emissiveFactor[static_cast<size_t>(c)]);

    const auto extension = from.extensions.find(kEmissiveStrength);
    if (extension != from.extensions.end() && extension->second.Has("emissiveStrength")) {
      const tinygltf::Value& strength = extension->second.Get("emissiveStrength");
      const double value = strength.IsNumber() ? strength.GetNumberAsDouble() : -1.0;
      if (!(value >= 0.0 && value <= 1e30)) return wrongFactor(at, "emissiveStrength", value);
      material.emission *= static_cast<float>(value);
    }
    if (Result<uint32_t> texture = use(pbr.baseColorTexture, true); assign(texture, material.base_color_texture))
      return texture.error();
    if (Result<uint32_t> texture = use(from.emissiveTexture, true); assign(texture, material.emissive_texture))
      return texture.error();

    if (from.alphaMode != "OPAQUE") once("alpha", "alpha modes are ignored: every surface is opaque");
    if (options_.lambert) return material;

    for (const auto& [name, value] : {std::pair{"metallicFactor", pbr.metallicFactor},
                                      {"roughnessFactor", pbr.roughnessFactor},
                                      {"normalTexture.scale", from.normalTexture.scale}}) {
      if (!std::isfinite(value) || std::fabs(value) > 1e6) return wrongFactor(at, name, value);
    }
    material.metallic = unit(pbr.metallicFactor);
    material.roughness = unit(pbr.roughnessFactor);
    material.normal_scale = static_cast<float>(from.normalTexture.scale);
    if (Result<uint32_t> texture = use(pbr.metallicRoughnessTexture, false);
        assign(texture, material.metallic_roughness_texture))
      return texture.error();
    if (Result<uint32_t> texture = use(from.normalTexture, false); assign(texture, material.normal_texture))
      return texture.error();
    return material;
  }

  /// Stores the texture; true when there was an error instead.
  static bool assign(const Result<uint32_t>& texture, uint32_t& field) {
    if (texture) field = *texture;
    return !texture.ok();
  }

  static float unit(double factor) { return static_cast<float>(std::clamp(factor, 0.0, 1.0)); }

  static Error wrongFactor(const std::string& at, const char* name, double value) {
    const std::string field = at + "." + name;
    return invalid(field, fmt::format("{}", value), fmt::format("{} is {}: it is out of range", field, value));
  }

  /// The scene's texture for a texture of the file, decoded at its first use. kNone when there is none.
  template <typename TextureInfo>
  Result<uint32_t> use(const TextureInfo& info, bool srgb) {
    if (info.index < 0) return kNone;
    if (info.texCoord != 0) once("uv set", "only uv set 0 is read: textures of other sets use it too");
    if (info.extensions.count("KHR_texture_transform") != 0)
      once("texture transform", "KHR_texture_transform is ignored");
    const tinygltf::Texture& texture = model_.textures[static_cast<size_t>(info.index)];
    if (texture.source < 0) {
      once("source", fmt::format("textures[{}] has no source that can be read and is left out", info.index));
      return kNone;
    }
    const auto [entry, is_new] =
        textures_.emplace(std::pair{texture.source, srgb}, static_cast<uint32_t>(scene_.textures.size()));
    if (!is_new) return entry->second;

    const tinygltf::Image& image = model_.images[static_cast<size_t>(texture.source)];
    std::string name = fmt::format("images[{}]", texture.source);
    Texture decoded;
    decoded.name = !image.name.empty() ? image.name : image.uri.empty() ? name : image.uri;
    decoded.srgb = srgb;
    if (!image.uri.empty()) name += fmt::format(" ({})", image.uri);
    if (image.image.empty())
      return invalid(name, "missing", name + " is missing: there is no such file in the model's folder");
    if (Result<void> result = decodeImage(image.image, options_.max_texture_size, bytes_left_, decoded); !result) {
      Error error = result.error();
      error.field = name;
      error.message = name + ": " + error.message;
      return error;
    }
    scene_.textures.push_back(std::move(decoded));
    return entry->second;
  }

  void once(const std::string& what, const std::string& line) {
    if (told_.emplace(what, true).second) spdlog::warn("glTF: {}", line);
  }

  const tinygltf::Model& model_;
  const GltfOptions& options_;
  Scene& scene_;
  uint64_t bytes_left_;
  std::map<std::pair<int, bool>, uint32_t> textures_;  // by image and encoding
  std::map<std::string, bool> told_;
};

}  // namespace

Result<void> importMaterials(const tinygltf::Model& model, const GltfOptions& options, Scene& scene) {
  return MaterialImporter(model, options, scene).import();
}

}  // namespace helio::scene
