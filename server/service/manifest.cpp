#include "service/manifest.h"

#include <openssl/evp.h>
#include <spdlog/fmt/fmt.h>

#include <memory>
#include <nlohmann/json.hpp>

namespace helio::service {
namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kFormat = 1;
// Of scene::generateCity(): one more whenever the same parameters give other prefabs or base instances.
constexpr unsigned kCityGenerator = 2;

Error unreadable(ErrorKind kind, const std::string& why) { return {kind, "manifest: " + why, "manifest", {}, {}}; }

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) { EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr); }
  void add(const void* bytes, size_t size) { EVP_DigestUpdate(context_.get(), bytes, size); }
  void add(uint64_t value) { add(&value, sizeof value); }
  void add(const std::string& text) {
    add(uint64_t{text.size()});
    add(text.data(), text.size());
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    add(uint64_t{values.size()});
    add(values.data(), values.size() * sizeof(T));
  }
  std::string hexadecimal() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned size = 0;
    EVP_DigestFinal_ex(context_.get(), digest, &size);
    std::string text;
    for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string Manifest::description() const {
  if (const auto* city = std::get_if<scene::CityParameters>(&source))
    return fmt::format("city seed {}, {} instances", city->seed, city->instances) +
           (city->animated > 0 ? fmt::format(", {} animated", city->animated) : "");
  return "gltf " + std::get<Gltf>(source).path;
}

bool Manifest::sameSource(const Manifest& other) const {
  return source.index() == other.source.index() && description() == other.description();
}

std::string encode(const Manifest& manifest) {
  Json json = {{"format", kFormat}};
  if (const auto* city = std::get_if<scene::CityParameters>(&manifest.source))
    json["city"] = {{"generator", kCityGenerator},
                    {"seed", city->seed},
                    {"instances", city->instances},
                    {"animated", city->animated}};
  else json["gltf"] = {{"path", std::get<Manifest::Gltf>(manifest.source).path}};
  json["digest"] = manifest.digest;
  return json.dump();
}

Result<Manifest> decodeManifest(const std::string& bytes) {
  const Json json = Json::parse(bytes, nullptr, false);
  if (json.is_discarded()) return unreadable(ErrorKind::damaged, "it is no JSON");
  try {
    const auto format = json.at("format").get<unsigned>();
    if (format > kFormat)
      return unreadable(
          ErrorKind::unsupported,
          fmt::format("format {}, this server knows formats up to {}: start the newer one", format, kFormat));
    Manifest manifest;
    manifest.digest = json.at("digest").get<std::string>();
    if (json.contains("city")) {
      const Json& city = json["city"];
      const auto generator = city.at("generator").get<unsigned>();
      if (generator != kCityGenerator)
        return unreadable(
            ErrorKind::unsupported,
            fmt::format("the city is of generator {}, this server has generator {}: start the one that made it",
                        generator, kCityGenerator));
      manifest.source = scene::CityParameters{city.at("seed").get<uint64_t>(), city.at("instances").get<uint32_t>(),
                                              city.at("animated").get<uint32_t>()};
    } else {
      manifest.source = Manifest::Gltf{json.at("gltf").at("path").get<std::string>()};
    }
    return manifest;
  } catch (const Json::exception& error) { return unreadable(ErrorKind::damaged, error.what()); }
}

std::string digestOf(const scene::Scene& scene, const Manifest& manifest) {
  const bool exact = std::holds_alternative<Manifest::Gltf>(manifest.source);
  Sha256 sha;
  sha.add(uint64_t{scene.prefabs.size()});
  for (const scene::Prefab& prefab : scene.prefabs) {
    const scene::Mesh& mesh = scene.meshes[prefab.mesh];
    sha.add(prefab.name);
    sha.add(uint64_t{prefab.buildable});
    sha.add(uint64_t{mesh.positions.size()});
    sha.add(mesh.indices);
    if (exact) sha.add(mesh.positions);
  }
  sha.add(uint64_t{scene.placements.size()});
  for (const scene::Placement& placement : scene.placements) {
    sha.add(uint64_t{placement.prefab});
    if (exact) sha.add(&placement.transform, sizeof placement.transform);
  }
  return "sha256:" + sha.hexadecimal();
}

}  // namespace helio::service
