#include "scene/gltf.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "scene/city.h"
#include "scene/gltf_extensions.h"
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

void reportModel(GltfImport& import) {
  const tinygltf::Model& model = import.model;
  ImportReport& report = import.report;
  report.extensions = model.extensionsUsed;
  for (const std::string& name : model.extensionsUsed) {
    if (!isSupportedExtension(name)) report.ignore(name, "this extension is not supported");
  }
}

Result<ScenePtr> import(const std::filesystem::path& file, const GltfOptions& options, ImportReport& report) {
  const Result<tinygltf::Model> model = loadModel(file);
  if (!model) return model.error();

  auto scene = std::make_shared<Scene>();
  scene->name = file.stem().string();
  scene->environment = daylight(kSunElevation, kSunAzimuth);
  GltfImport import{*model, options, *scene, report};
  reportModel(import);
  const Result<std::vector<UvChannels>> channels_of_material = importMaterials(import);
  if (!channels_of_material) return channels_of_material.error();
  const Result<std::vector<uint32_t>> prefab_of_mesh = importMeshes(import, *channels_of_material);
  if (!prefab_of_mesh) return prefab_of_mesh.error();
  if (Result<void> done = importNodes(import, *prefab_of_mesh); !done) return done.error();

  if (scene->placements.empty()) return invalid("", "", "its scene shows no triangles");
  const Aabb bounds = scene->bounds();
  if (!std::isfinite(glm::length(bounds.extent())) || !std::isfinite(glm::length(bounds.centre()))) {
    return invalid("", "", "its transforms take its vertices beyond what numbers can hold");
  }
  report.instances = scene->placements.size();
  report.lights = scene->lights.size();
  report.cameras = scene->cameras.size();
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

bool GltfImport::uses(const char* extension) const {
  const auto lists = [extension](const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), extension) != names.end();
  };
  return lists(model.extensionsUsed) || lists(model.extensionsRequired);
}

Result<ScenePtr> loadGltf(const std::filesystem::path& file, const GltfOptions& options, ImportReport* report) {
  ImportReport own;
  ImportReport& told = report != nullptr ? *report : own;
  told = {};
  told.file = file.string();
  Result<ScenePtr> scene = import(file, options, told);
  if (!scene) {
    Error error = scene.error();
    error.message = told.file + ": " + error.message;
    if (error.field.empty()) error.field = "file";
    return error;
  }
  spdlog::info("{}: {}", told.file, summary(told));
  for (const ImportReport::Ignored& ignored : told.ignored) spdlog::warn("{}: {}", told.file, line(ignored));
  return scene;
}

}  // namespace helio::scene
