#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "scene/gltf_extensions.h"
#include "scene/gltf_image.h"
#include "scene/gltf_import.h"

namespace helio::scene {
namespace {

constexpr bool kColor = true, kData = false;  // how an image's bytes are meant

/// A texture of a material as the file has it.
struct TextureUse {
  int texture = -1;
  UvMapping mapping;
};

// Extensions were checked by gltf_extensions.cpp: what is there has the right type and range.
float numberOf(const tinygltf::Value& object, const char* key, float fallback) {
  return object.Has(key) ? static_cast<float>(object.Get(key).GetNumberAsDouble()) : fallback;
}

template <typename Vector>
Vector vectorOf(const tinygltf::Value& object, const char* key, Vector vector) {
  if (!object.Has(key)) return vector;
  for (int c = 0; c < Vector::length(); ++c)
    vector[c] = static_cast<float>(object.Get(key).Get(static_cast<size_t>(c)).GetNumberAsDouble());
  return vector;
}

UvMapping mappingOf(int set, const tinygltf::Value* transform) {
  UvMapping mapping;
  mapping.set = set;
  if (transform == nullptr) return mapping;
  mapping.offset = vectorOf(*transform, "offset", mapping.offset);
  mapping.rotation = numberOf(*transform, "rotation", mapping.rotation);
  mapping.scale = vectorOf(*transform, "scale", mapping.scale);
  if (transform->Has("texCoord")) mapping.set = transform->Get("texCoord").GetNumberAsInt();
  return mapping;
}

const tinygltf::Value* find(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

/// From tinygltf's structures, and from the JSON of an extension.
template <typename TextureInfo>
TextureUse useOf(const TextureInfo& info) {
  return {info.index, mappingOf(info.texCoord, find(info.extensions, kTextureTransform))};
}
TextureUse useOf(const tinygltf::Value& owner, const char* key) {
  if (!owner.Has(key)) return {};
  const tinygltf::Value& info = owner.Get(key);
  const int set = info.Has("texCoord") ? info.Get("texCoord").GetNumberAsInt() : 0;
  const tinygltf::Value* transform = nullptr;
  if (info.Has("extensions") && info.Get("extensions").Has(kTextureTransform))
    transform = &info.Get("extensions").Get(kTextureTransform);
  return {info.Get("index").GetNumberAsInt(), mappingOf(set, transform)};
}

/// Numbers the mappings of one material's textures.
class ChannelList {
 public:
  uint8_t channelOf(const UvMapping& mapping) {
    const auto known = std::find(channels_.begin(), channels_.end(), mapping);
    if (known != channels_.end()) return static_cast<uint8_t>(known - channels_.begin());
    channels_.push_back(mapping);
    return static_cast<uint8_t>(channels_.size() - 1);
  }
  UvChannels take() && {
    if (channels_.empty()) channels_.emplace_back();
    return std::move(channels_);
  }

 private:
  UvChannels channels_;
};

class MaterialImporter {
 public:
  explicit MaterialImporter(GltfImport& import) : import_(import), bytes_left_(import.options.max_texture_bytes) {}

  Result<std::vector<UvChannels>> import() {
    const std::vector<tinygltf::Material>& materials = import_.model.materials;
    for (size_t i = 0; i < materials.size(); ++i) {
      Result<Material> material = importMaterial(materials[i], fmt::format("materials[{}]", i));
      if (!material) return material.error();
      import_.scene.materials.push_back(std::move(*material));
    }
    Material none;  // what the specification gives to primitives without a material
    none.name = "default";
    none.metallic = 1.0f;
    import_.scene.materials.push_back(std::move(none));
    channels_of_material_.emplace_back(1);
    import_.report.materials = materials.size();
    import_.report.textures = import_.scene.textures.size();
    return std::move(channels_of_material_);
  }

 private:
  Result<Material> importMaterial(const tinygltf::Material& from, const std::string& at) {
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    Material material;
    material.name = from.name;
    material.unlit = find(from.extensions, kMaterialUnlit) != nullptr;
    for (int c = 0; c < 4; ++c) material.base_color[c] = unit(pbr.baseColorFactor[static_cast<size_t>(c)]);
    if (from.alphaMode == "MASK") {
      if (!std::isfinite(from.alphaCutoff) || from.alphaCutoff < 0.0)
        return invalid(at + ".alphaCutoff", fmt::format("{}", from.alphaCutoff),
                       fmt::format("{}.alphaCutoff is {}: it must be 0 or more", at, from.alphaCutoff));
      material.alpha_cutoff = static_cast<float>(from.alphaCutoff);
    } else if (from.alphaMode != "OPAQUE") {
      import_.report.ignore("alpha blending", "the surface is opaque");
    }
    if (from.occlusionTexture.index >= 0)
      import_.report.ignore("occlusion textures", "paths of light find what is occluded");

    ChannelList channels;
    std::optional<Error> error;
    const auto use = [&](TextureSlot slot, const TextureUse& used, bool color, uint32_t& texture) {
      if (error) return;
      const Result<uint32_t> decoded = decode(used.texture, color);
      if (!decoded) {
        error = decoded.error();
      } else if (*decoded != kNone) {
        texture = *decoded;
        material.uv_channel[static_cast<size_t>(slot)] = channels.channelOf(used.mapping);
      }
    };
    if (!material.unlit) {  // before all others, to get channel 0
      for (int c = 0; c < 3; ++c) material.emission[c] = unit(from.emissiveFactor[static_cast<size_t>(c)]);
      if (const tinygltf::Value* strength = find(from.extensions, kEmissiveStrength))
        material.emission *= numberOf(*strength, "emissiveStrength", 1.0f);
      use(TextureSlot::emissive, useOf(from.emissiveTexture), kColor, material.emissive_texture);
    }
    use(TextureSlot::base_color, useOf(pbr.baseColorTexture), kColor, material.base_color_texture);
    if (!material.unlit) {
      if (Result<void> read = readFactors(from, at, material); !read) return read.error();
      use(TextureSlot::metallic_roughness, useOf(pbr.metallicRoughnessTexture), kData,
          material.metallic_roughness_texture);
      use(TextureSlot::normal, useOf(from.normalTexture), kData, material.normal_texture);
      if (const tinygltf::Value* specular = find(from.extensions, kMaterialSpecular)) {
        material.specular = numberOf(*specular, "specularFactor", 1.0f);
        material.specular_color = vectorOf(*specular, "specularColorFactor", glm::vec3(1.0f));
        use(TextureSlot::specular, useOf(*specular, "specularTexture"), kData, material.specular_texture);
        use(TextureSlot::specular_color, useOf(*specular, "specularColorTexture"), kColor,
            material.specular_color_texture);
      }
    }
    if (error) return *error;
    channels_of_material_.push_back(std::move(channels).take());
    return material;
  }

  static Result<void> readFactors(const tinygltf::Material& from, const std::string& at, Material& material) {
    const tinygltf::PbrMetallicRoughness& pbr = from.pbrMetallicRoughness;
    for (const auto& [name, value] : {std::pair{"metallicFactor", pbr.metallicFactor},
                                      {"roughnessFactor", pbr.roughnessFactor},
                                      {"normalTexture.scale", from.normalTexture.scale}}) {
      if (std::isfinite(value) && std::fabs(value) <= 1e6) continue;
      const std::string field = at + "." + name;
      return invalid(field, fmt::format("{}", value), fmt::format("{} is {}: it is out of range", field, value));
    }
    material.metallic = unit(pbr.metallicFactor);
    material.roughness = unit(pbr.roughnessFactor);
    material.normal_scale = static_cast<float>(from.normalTexture.scale);
    if (const tinygltf::Value* ior = find(from.extensions, kMaterialIor))
      material.ior = numberOf(*ior, "ior", material.ior);
    return {};
  }

  static float unit(double factor) { return static_cast<float>(std::clamp(factor, 0.0, 1.0)); }

  /// The scene's texture for a texture of the file, decoded at its first use. kNone when there is none.
  Result<uint32_t> decode(int index, bool srgb) {
    if (index < 0) return kNone;
    const tinygltf::Texture& texture = import_.model.textures[static_cast<size_t>(index)];
    if (texture.source < 0) {
      import_.report.ignore(fmt::format("textures[{}]", index), "it has no source that can be read");
      return kNone;
    }
    std::vector<Texture>& textures = import_.scene.textures;
    const Sampling sampling = samplingOf(texture);
    const auto [entry, is_new] =
        textures_.emplace(std::tuple{texture.source, srgb, sampling}, static_cast<uint32_t>(textures.size()));
    if (!is_new) return entry->second;

    const tinygltf::Image& image = import_.model.images[static_cast<size_t>(texture.source)];
    std::string name = fmt::format("images[{}]", texture.source);
    Texture decoded;
    decoded.name = !image.name.empty() ? image.name : image.uri.empty() ? name : image.uri;
    decoded.srgb = srgb;
    decoded.sampling = sampling;
    if (!image.uri.empty()) name += fmt::format(" ({})", image.uri);
    if (image.image.empty())
      return invalid(name, "missing", name + " is missing: there is no such file in the model's folder");
    if (Result<void> result = decodeImage(image.image, import_.options.max_texture_size, bytes_left_, decoded);
        !result) {
      Error error = result.error();
      error.field = name;
      error.message = name + ": " + error.message;
      return error;
    }
    textures.push_back(std::move(decoded));
    return entry->second;
  }

  Sampling samplingOf(const tinygltf::Texture& texture) const {
    if (texture.sampler < 0) return {};
    const tinygltf::Sampler& sampler = import_.model.samplers[static_cast<size_t>(texture.sampler)];
    const auto wrap = [](int mode) {
      return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::clamp
             : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirrored_repeat
                                                             : Wrap::repeat;
    };
    return {sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST, wrap(sampler.wrapS), wrap(sampler.wrapT)};
  }

  GltfImport& import_;
  uint64_t bytes_left_;
  std::map<std::tuple<int, bool, Sampling>, uint32_t> textures_;  // by image, encoding and sampler
  std::vector<UvChannels> channels_of_material_;
};

}  // namespace

glm::vec2 UvMapping::operator()(const glm::vec2& uv) const {
  const glm::vec2 scaled = uv * scale;
  const float c = std::cos(rotation), s = std::sin(rotation);
  return offset + glm::vec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

Result<std::vector<UvChannels>> importMaterials(GltfImport& import) { return MaterialImporter(import).import(); }

}  // namespace helio::scene
