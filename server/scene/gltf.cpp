#include "scene/gltf.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "scene/city.h"
#include "scene/gltf_import.h"
#include "scene/gltf_model.h"

namespace helio::scene {
namespace {

// glTF says nothing about sun and sky: a late morning, the sun to the front and the right of what faces +z.
constexpr float kSunElevation = 0.85f, kSunAzimuth = 0.6f;

/// Sees the whole of `bounds` in a picture at least as wide as high, from the front, the right and above.
Camera frame(const Aabb& bounds) {
  Camera camera;
  camera.vfov = 0.8f;
  camera.forward = glm::normalize(glm::vec3(-0.4f, -0.3f, -1.0f));
  const float radius = std::max(0.5f * glm::length(bounds.extent()), 1e-3f);
  camera.position = bounds.centre() - camera.forward * (radius / std::sin(0.5f * camera.vfov));
  return camera;
}

Result<ScenePtr> import(const std::filesystem::path& file, const GltfOptions& options) {
  const Result<tinygltf::Model> model = loadModel(file);
  if (!model) return model.error();

  auto scene = std::make_shared<Scene>();
  scene->name = file.stem().string();
  scene->environment = daylight(kSunElevation, kSunAzimuth);
  if (Result<void> done = importMaterials(*model, options, *scene); !done) return done.error();
  const Result<std::vector<uint32_t>> prefab_of_mesh = importMeshes(*model, options, *scene);
  if (!prefab_of_mesh) return prefab_of_mesh.error();
  if (Result<void> done = importNodes(*model, *prefab_of_mesh, *scene); !done) return done.error();

  if (scene->placements.empty()) return invalid("", "", "its scene shows no triangles");
  const Aabb bounds = scene->bounds();
  if (!std::isfinite(glm::length(bounds.extent())) || !std::isfinite(glm::length(bounds.centre()))) {
    return invalid("", "", "its transforms take its vertices beyond what numbers can hold");
  }
  if (scene->cameras.empty())
    scene->cameras.push_back({"overview", "the whole model", frame(bounds), scene->environment});
  return ScenePtr(std::move(scene));
}

}  // namespace

std::string UniqueNames::take(const std::string& wanted) {
  std::string name = wanted;
  for (uint32_t& copies = copies_of_[wanted]; !taken_.insert(name).second;)
    name = fmt::format("{}_{}", wanted, ++copies + 1);
  return name;
}

Result<ScenePtr> loadGltf(const std::filesystem::path& file, const GltfOptions& options) {
  Result<ScenePtr> scene = import(file, options);
  if (scene) return scene;
  Error error = scene.error();
  error.message = file.string() + ": " + error.message;
  if (error.field.empty()) error.field = "file";
  return error;
}

}  // namespace helio::scene
