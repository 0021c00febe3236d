#include "service/world_source.h"

#include <algorithm>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "scene/gltf.h"

namespace helio::service {

namespace fs = std::filesystem;

namespace {

using Loader = std::function<Result<scene::ScenePtr>()>;

Outcome<Loader> cityLoader(const scene::CityParameters& parameters, const Limits& limits) {
  const uint64_t low = 1'000, high = std::min<uint64_t>(1'000'000, limits.world.max_instances);
  if (parameters.instances < low || parameters.instances > high)
    return outOfRange("city.instances", std::to_string(parameters.instances), fmt::format("[{}, {}]", low, high));
  return Loader([parameters] { return scene::generateCity(parameters); });
}

Outcome<Loader> gltfLoader(const fs::path& root, const std::string& path) {
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
  return Loader([file] { return scene::loadGltf(file); });
}

}  // namespace

Outcome<WorldSource> sourceOf(Manifest manifest, const fs::path& gltf_root, const Limits& limits) {
  const auto* city = std::get_if<scene::CityParameters>(&manifest.source);
  auto loader =
      city ? cityLoader(*city, limits) : gltfLoader(gltf_root, std::get<Manifest::Gltf>(manifest.source).path);
  if (!loader) return loader.error();
  return WorldSource{std::move(manifest), std::move(*loader)};
}

Outcome<WorldSource> sourceOf(const v1::CreateWorldRequest& request, const fs::path& gltf_root, const Limits& limits) {
  switch (request.source_case()) {
    case v1::CreateWorldRequest::kCity:
      return sourceOf({scene::CityParameters{request.city().seed(), request.city().instances()}, {}}, gltf_root,
                      limits);
    case v1::CreateWorldRequest::kGltf:
      return sourceOf({Manifest::Gltf{request.gltf().path()}, {}}, gltf_root, limits);
    case v1::CreateWorldRequest::SOURCE_NOT_SET:
      break;
  }
  return outOfRange("source", "missing", "city, gltf");
}

}  // namespace helio::service
