#include "bench/stage.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <limits>
#include <utility>

#include "scene/city.h"
#include "scene/gltf.h"
#include "support/scenes.h"

namespace helio::bench {
namespace {

constexpr float kStroke = 0.001f;          // metres
constexpr double kTickSeconds = 1.0 / 60;  // of world time
constexpr uint32_t kInstances = 10'000;
constexpr uint64_t kSeed = 1;

/// The pose with this transform, if there is one.
std::optional<world::Pose> poseOf(const glm::mat4x3& transform) {
  world::Pose pose;
  pose.position = transform[3];
  pose.scale = glm::length(transform[0]);
  if (!(pose.scale > 0.0f)) return std::nullopt;
  const glm::mat3 axes(transform[0], transform[1], transform[2]);
  pose.rotation = glm::normalize(glm::quat_cast(axes * (1.0f / pose.scale)));
  const glm::mat4x3 rebuilt = pose.matrix();
  for (int column = 0; column < 3; ++column)
    if (!(glm::distance(rebuilt[column], transform[column]) < 1e-3f * pose.scale)) return std::nullopt;
  return pose;
}

}  // namespace

Result<scene::ScenePtr> makeScene(const StageOptions& options) {
  if (options.scene != "city") return scene::loadGltf(options.scene);
  return scene::generateCity(
      {options.seed.value_or(kSeed), options.instances.value_or(kInstances), options.animated.value_or(0)});
}

Result<const scene::NamedCamera*> findCamera(const scene::Scene& scene, const std::string& name) {
  if (name.empty()) return &scene.cameras.front();
  const auto found = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                  [&](const scene::NamedCamera& camera) { return camera.name == name; });
  if (found != scene.cameras.end()) return &*found;
  std::string names;
  for (const scene::NamedCamera& camera : scene.cameras) names += (names.empty() ? "" : ", ") + camera.name;
  return Error{
      ErrorKind::not_found, "the scene has no camera \"" + name + "\": give one of " + names, "--camera", name, {}};
}

scene::ScenePtr withMirror(const scene::Scene& plain, scene::Camera& camera) {
  scene::Scene scene = plain;
  scene::Mesh mesh = test::quad(1.0f);
  scene.materials.push_back(test::metal(glm::vec3(0.95f), 0.0f));
  mesh.name = "mirror";
  mesh.submeshes = {{0, 6, static_cast<uint32_t>(scene.materials.size() - 1)}};
  mesh.finish();
  scene.meshes.push_back(std::move(mesh));
  scene.prefabs.push_back({"mirror", "test", static_cast<uint32_t>(scene.meshes.size() - 1), true});
  // Seen from behind itself the camera's view is what the mirror shows.
  constexpr float kWide = 30.0f, kAway = 12.0f;
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward, camera.up));
  const glm::vec3 up = glm::cross(right, camera.forward);
  const glm::vec3 place = camera.position - camera.forward * kAway;
  scene.placements.push_back({static_cast<uint32_t>(scene.prefabs.size() - 1),
                              glm::mat4x3(right * kWide, camera.forward * kWide, -up * kWide, place)});
  camera.forward = -camera.forward;
  return std::make_shared<scene::Scene>(std::move(scene));
}

void addStageOptions(CLI::App& command, StageOptions& options) {
  command.add_option("--scene", options.scene, "city, or a .gltf or .glb file")->capture_default_str();
  command.add_option("--camera", options.camera,
                     "one of the scene's cameras by name, in its own light; default: its first");
  command.add_option("--instances", options.instances,
                     "static instances of the city, 1,000 to 1,000,000; default: 10,000");
  command.add_option("--animated", options.animated, "moving units of the city, 0 to 10,000; default: 0");
  command.add_option("--seed", options.seed, "of the city; default: 1");
}

void addSizeOption(CLI::App& command, uint32_t& width, uint32_t& height) {
  const auto parse = [&width, &height](const std::string& text) {
    int end = 0;
    const bool whole =
        std::sscanf(text.c_str(), "%5ux%5u%n", &width, &height, &end) == 2 && static_cast<size_t>(end) == text.size();
    if (!whole)
      throw CLI::ValidationError("--size", "\"" + text + "\" is no size: give WIDTHxHEIGHT such as 1920x1080");
  };
  command.add_option_function<std::string>("--size", parse, "picture, in pixels: WIDTHxHEIGHT")
      ->default_str(std::to_string(width) + "x" + std::to_string(height));
}

Result<void> check(const StageOptions& options) {
  if (options.scene != "city" && (options.instances || options.seed || options.animated))
    return invalid("--scene", options.scene,
                   "--instances, --animated and --seed are the city's: leave them out with --scene " + options.scene);
  return {};
}

Result<world::Move> findMover(const scene::Scene& scene) {
  std::optional<world::Move> mover;
  float smallest = std::numeric_limits<float>::infinity();
  for (size_t i = 0; i < scene.placements.size(); ++i) {
    const scene::Placement& placement = scene.placements[i];
    const scene::Prefab& prefab = scene.prefabs[placement.prefab];
    if (!prefab.buildable) continue;
    const float size = glm::length(scene::transform(scene.meshes[prefab.mesh].bounds, placement.transform).extent());
    if (!(size < smallest)) continue;
    const std::optional<world::Pose> pose = poseOf(placement.transform);
    if (!pose) continue;
    smallest = size;
    mover = world::Move{i + 1, *pose};  // base placements have ids from 1 on
  }
  if (mover) return *mover;
  return Error{
      ErrorKind::unsupported,
      "scene \"" + scene.name +
          "\" has no instance that can be moved (one without shear, mirroring or uneven scale): choose another scene",
      "--scene",
      scene.name,
      {}};
}

Stage::Stage(std::unique_ptr<world::World> world, const scene::NamedCamera& camera, world::Move mover)
    : world_(std::move(world)), camera_(&camera), mover_(std::move(mover)) {}

Result<Stage> Stage::open(const StageOptions& options) {
  Result<scene::ScenePtr> scene = makeScene(options);
  if (!scene) return scene.error();
  const Result<const scene::NamedCamera*> camera = findCamera(**scene, options.camera);
  if (!camera) return camera.error();
  const Result<world::Move> mover = findMover(**scene);
  if (!mover) return mover.error();
  auto world = std::make_unique<world::World>(*scene);
  // A camera's picture is meant to be seen in its own light.
  if (auto lit = world->apply(1, {{world::ResolvedEnvironment{(*camera)->environment}}}); !lit) return lit.error();
  return Stage(std::move(world), **camera, *mover);
}

Result<world::ChangeSet> Stage::advance() {
  raised_ = !raised_;
  world::Move move = mover_;
  if (raised_) move.pose.position.y += kStroke;
  const world::Edit edit = move;
  const Result<world::Batch> batch = world_->resolve({&edit, 1});
  if (!batch) return batch.error();
  if (auto applied = world_->apply(world_->seq() + 1, *batch); !applied) return applied.error();
  return world_->beginTick(kTickSeconds);
}

}  // namespace helio::bench
