// What is measured: a scene as a world, seen by a camera, in which something moves.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "scene/scene.h"
#include "world/world.h"

namespace CLI {
class App;
}

namespace helio::bench {

struct StageOptions {
  std::string scene = "city";         ///< "city", or a .gltf or .glb file
  std::string camera;                 ///< a name; empty: the scene's first
  std::optional<uint32_t> instances;  ///< of the city, default 10,000
  std::optional<uint64_t> seed;       ///< of the city, default 1
  std::optional<uint32_t> animated;   ///< units of the city, default 0
};

/// The scene that the options name.
Result<scene::ScenePtr> makeScene(const StageOptions& options);
/// One of the scene's cameras by name; without a name its first. Errors: not_found.
Result<const scene::NamedCamera*> findCamera(const scene::Scene& scene, const std::string& name);
/// The scene with a mirror as wide as a street block, and the camera that looks into it: it shows what stands behind.
scene::ScenePtr withMirror(const scene::Scene& scene, scene::Camera& camera);

/// --scene, --camera, --instances, --animated and --seed, which refer to `options` from then on.
void addStageOptions(CLI::App& command, StageOptions& options);
/// --size WIDTHxHEIGHT.
void addSizeOption(CLI::App& command, uint32_t& width, uint32_t& height);
/// Errors (invalid): the city's flags with a file.
Result<void> check(const StageOptions& options);

/// A server's world always has something that changes, so a frame of it updates the instance table and builds the TLAS.
/// On the stage one small instance stands in for all that: every tick moves it by 1 mm, up and down in turn, through
/// the world's own resolve() and apply(). It costs a tick what a single edit costs, and the picture stays the same.
class Stage {
 public:
  /// Makes or loads the scene. Errors: the scene's own; not_found: no such camera; unsupported: nothing that can move.
  static Result<Stage> open(const StageOptions& options);

  /// Moves the mover and the clock: what the renderer must know before the next frame.
  Result<world::ChangeSet> advance();

  const scene::ScenePtr& scene() const { return world_->scenePtr(); }
  const scene::NamedCamera& camera() const { return *camera_; }
  uint64_t instances() const { return world_->instanceCount(); }

 private:
  Stage(std::unique_ptr<world::World> world, const scene::NamedCamera& camera, world::Move mover);

  std::unique_ptr<world::World> world_;
  const scene::NamedCamera* camera_;  // of the scene, which the world holds
  world::Move mover_;
  bool raised_ = false;
};

/// The instance that Stage moves, with the pose at which it rests: the smallest that users may move and whose transform
/// is a pose (no shear, no mirroring, one scale). Errors: unsupported.
Result<world::Move> findMover(const scene::Scene& scene);

}  // namespace helio::bench
