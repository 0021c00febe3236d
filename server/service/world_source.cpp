#include "service/world_source.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "scene/gltf.h"

namespace helio::service {

namespace fs = std::filesystem;

namespace {

/// RFC 3986, section 2.1.
std::string percentDecoded(const std::string& uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size()) {
      text += static_cast<char>(std::strtol(uri.substr(i + 1, 2).c_str(), nullptr, 16));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

using Loader = std::function<Result<scene::ScenePtr>()>;

Outcome<Loader> cityLoader(const scene::CityParameters& parameters, const Limits& limits) {
  const uint64_t low = 1'000, high = std::min<uint64_t>(1'000'000, limits.world.max_instances);
  if (parameters.instances < low || parameters.instances > high)
    return outOfRange("city.instances", std::to_string(parameters.instances), fmt::format("[{}, {}]", low, high));
  if (parameters.animated > 10'000)
    return outOfRange("city.animated", std::to_string(parameters.animated), "[0, 10000]");
  return Loader([parameters] { return scene::generateCity(parameters); });
}

/// Bytes of the file and, for a .gltf, of the buffers and images that it names beside it. What cannot be read counts
/// nothing here: the importer says what is wrong with it.
uint64_t sceneBytes(const fs::path& file) {
  std::error_code error;
  const auto sizeOf = [&error](const fs::path& path) {
    const uint64_t size = fs::file_size(path, error);
    return error ? 0 : size;
  };
  uint64_t bytes = sizeOf(file);
  if (file.extension() != ".gltf") return bytes;
  std::ifstream text(file);
  const auto json = nlohmann::json::parse(text, nullptr, false);
  for (const char* kind : {"buffers", "images"}) {
    if (!json.is_object() || !json.contains(kind) || !json[kind].is_array()) continue;
    for (const auto& entry : json[kind])
      if (entry.is_object() && entry.contains("uri") && entry["uri"].is_string() &&
          entry["uri"].get_ref<const std::string&>().compare(0, 5, "data:") != 0)
        bytes += sizeOf(file.parent_path() / percentDecoded(entry["uri"].get<std::string>()));
  }
  return bytes;
}

Result<void> checkSize(const fs::path& file, const Limits& limits) {
  const uint64_t bytes = sceneBytes(file);
  if (bytes <= limits.max_scene_bytes) return {};
  return Error{ErrorKind::limit,
               fmt::format("the scene has {} bytes; this server loads {} at most (max-scene-bytes)", bytes,
                           limits.max_scene_bytes),
               "gltf.path", std::to_string(bytes), std::to_string(limits.max_scene_bytes)};
}

Outcome<Loader> gltfLoader(const fs::path& root, const std::string& path, const Limits& limits) {
  const std::string field = "gltf.path";
  if (root.empty())
    return Failure(Error{
        ErrorKind::unsupported, "this server loads no glTF files; start it with --gltf-root FOLDER", field, path, {}});
  std::error_code error;
  const fs::path allowed = fs::canonical(root, error);
  if (error)
    return Failure(
        Error{ErrorKind::unsupported, "the server's glTF folder cannot be read: " + error.message(), field, path, {}});
  if (path.empty() || fs::path(path).is_absolute())
    return outOfRange(field, fmt::format("\"{}\"", path), "paths relative to the server's glTF folder");
  const fs::path file = fs::weakly_canonical(allowed / path, error);
  const bool inside =
      !error && std::mismatch(allowed.begin(), allowed.end(), file.begin(), file.end()).first == allowed.end();
  if (!inside) return outOfRange(field, fmt::format("\"{}\"", path), "paths inside the server's glTF folder");
  if (!fs::is_regular_file(file, error))
    return Failure(
        Error{ErrorKind::not_found, "there is no file \"" + path + "\" in the server's glTF folder", field, path, {}});
  return Loader([file, limits]() -> Result<scene::ScenePtr> {
    if (auto fits = checkSize(file, limits); !fits) return fits.error();
    return scene::loadGltf(file);
  });
}

}  // namespace

Outcome<WorldSource> sourceOf(Manifest manifest, const fs::path& gltf_root, const Limits& limits) {
  const auto* city = std::get_if<scene::CityParameters>(&manifest.source);
  auto loader =
      city ? cityLoader(*city, limits) : gltfLoader(gltf_root, std::get<Manifest::Gltf>(manifest.source).path, limits);
  if (!loader) return loader.error();
  return WorldSource{std::move(manifest), std::move(*loader)};
}

Outcome<WorldSource> sourceOf(const v1::CreateWorldRequest& request, const fs::path& gltf_root, const Limits& limits) {
  switch (request.source_case()) {
    case v1::CreateWorldRequest::kCity:
      return sourceOf(
          {scene::CityParameters{request.city().seed(), request.city().instances(), request.city().animated()}, {}},
          gltf_root, limits);
    case v1::CreateWorldRequest::kGltf:
      return sourceOf({Manifest::Gltf{request.gltf().path()}, {}}, gltf_root, limits);
    case v1::CreateWorldRequest::SOURCE_NOT_SET:
      break;
  }
  return outOfRange("source", "missing", "city, gltf");
}

}  // namespace helio::service
