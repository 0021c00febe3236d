#include "scene/gltf_extensions.h"

#include <algorithm>
#include <limits>

namespace helio::scene {
namespace {

using nlohmann::json;

constexpr uint64_t kMaxUvSet = 255;
constexpr double kMost = std::numeric_limits<float>::max();
constexpr double kHalfPi = 1.5707963267948966;

}  // namespace

bool isSupportedExtension(std::string_view name) {
  return std::any_of(kSupportedExtensions.begin(), kSupportedExtensions.end(),
                     [name](const char* supported) { return name == supported; });
}

void checkTextureInfo(GltfChecker& checker, const json& owner, const std::string& at, const char* key) {
  const json& info = checker.object(owner, at, key);
  if (info.is_null()) return;
  const std::string here = GltfChecker::join(at, key);
  checker.index(GltfChecker::member(info, "index"), here + ".index", "textures");
  checker.integer(info, here, "texCoord", 0, 0, kMaxUvSet);

  std::string place;
  const json& transform = checker.extension(info, here, kTextureTransform, place);
  checker.numbers(transform, place, "offset", 2);
  checker.numbers(transform, place, "scale", 2);
  checker.number(transform, place, "rotation", 0.0, -kMost, kMost);
  checker.integer(transform, place, "texCoord", 0, 0, kMaxUvSet);
}

void checkMaterialExtensions(GltfChecker& checker, const json& material, const std::string& at) {
  std::string place;
  const json& strength = checker.extension(material, at, kEmissiveStrength, place);
  checker.number(strength, at, "emissiveStrength", 1.0, 0.0, 1e30);

  const json& ior = checker.extension(material, at, kMaterialIor, place);
  if (checker.number(ior, place, "ior", 1.5, 0.0, kMost) < 1.0 && GltfChecker::member(ior, "ior") != 0.0)
    checker.fail(place + ".ior", GltfChecker::member(ior, "ior"), "it must be 0, or 1 or more");

  const json& specular = checker.extension(material, at, kMaterialSpecular, place);
  checker.number(specular, place, "specularFactor", 1.0, 0.0, 1.0);
  checker.numbers(specular, place, "specularColorFactor", 3, 0.0, kMost);
  checkTextureInfo(checker, specular, place, "specularTexture");
  checkTextureInfo(checker, specular, place, "specularColorTexture");
  checker.extension(material, at, kMaterialUnlit, place);
}

void checkLights(GltfChecker& checker) {
  std::string place;
  const json& extension = checker.extension(checker.root(), "", kLightsPunctual, place);
  checker.listOfObjects(extension, place, "lights");
  const json& lights = GltfChecker::member(extension, "lights");
  for (size_t i = 0; i < lights.size() && !checker.error(); ++i) {
    const std::string at = fmt::format("{}.lights[{}]", place, i);
    const json& light = lights[i];
    const json& type = GltfChecker::member(light, "type");
    if (type != "directional" && type != "point" && type != "spot")
      checker.fail(at + ".type", type, "it must be \"directional\", \"point\" or \"spot\"");
    checker.numbers(light, at, "color", 3, 0.0, kMost);
    checker.number(light, at, "intensity", 1.0, 0.0, kMost);
    if (checker.number(light, at, "range", 1.0, 0.0, kMost) <= 0.0)
      checker.fail(at + ".range", GltfChecker::member(light, "range"), "it must be above 0");
    const json& cone = checker.object(light, at, "spot");
    if (type == "spot" && cone.is_null()) checker.fail(at + ".spot", cone, "a spot needs its cone");
    const double outer = checker.number(cone, at + ".spot", "outerConeAngle", 0.5 * kHalfPi, 0.0, kHalfPi + 1e-6);
    const double inner = checker.number(cone, at + ".spot", "innerConeAngle", 0.0, 0.0, kHalfPi);
    if (!(inner < outer)) {
      checker.fail(at + ".spot.innerConeAngle", inner,
                   fmt::format("it must be less than the outerConeAngle of {}", outer));
    }
  }
}

void checkNodeExtensions(GltfChecker& checker, const json& node, const std::string& at) {
  std::string place;
  const json& instancing = checker.extension(node, at, kGpuInstancing, place);
  if (!instancing.is_null()) {
    const json& attributes = checker.object(instancing, place, "attributes");
    if (attributes.is_null()) checker.fail(place + ".attributes", attributes, "instances need attributes");
    for (const auto& [name, accessor] : attributes.items())
      checker.index(accessor, place + ".attributes." + name, "accessors");
  }

  const json& emitter = checker.extension(node, at, kLightsPunctual, place);
  if (emitter.is_null()) return;
  const json& light = GltfChecker::member(emitter, "light");
  std::string lights_place;
  const size_t lights =
      GltfChecker::member(checker.extension(checker.root(), "", kLightsPunctual, lights_place), "lights").size();
  if (!light.is_number_unsigned() || light.get<uint64_t>() >= lights)
    checker.fail(place + ".light", light, fmt::format("it must be the index of one of {} lights", lights));
}

}  // namespace helio::scene
