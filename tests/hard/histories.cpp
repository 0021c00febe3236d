#include "hard/histories.h"

#include <cmath>

#include "support/scenes.h"

namespace helio::test {
namespace {

using glm::vec3;

float f(double v) { return static_cast<float>(v); }

/// A plane of albedo 0.5 under a sky of radiance 1, and `metres` from it a lamp 1000 times as bright as the sky, which
/// the plane does not see.
scene::ScenePtr planeAndLamp(double metres) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(2.0f), b.material(lambert(vec3(0.5f)))));
  b.place(b.prefab("lamp", quad(2.0f), b.material(lambert(vec3(0.0f), vec3(1000.0f)))), at({f(metres), -1, 0}));
  b.environment().sky = {vec3(1.0f), vec3(1.0f)};
  return b.build();
}

scene::Camera above(double metres, float y) { return lookAt({f(metres), y + 1.0f, 0}, {f(metres), y, 0}, 0.05f); }

HardScene afterALamp(double metres, uint32_t size) {
  HardScene s{planeAndLamp(metres), above(0.0, 0.0f)};
  s.truth = 0.5;
  s.before.assign(3, {above(metres, -1.0f), size});
  return s;
}

}  // namespace

HardScene stillLifeAt(double metres) {
  const vec3 offset(f(metres), 0.0f, f(metres));
  const scene::ScenePtr here = stillLife();
  scene::Scene moved = *here;
  for (scene::Placement& placement : moved.placements) placement.transform[3] += offset;
  const scene::Camera camera = lookAt({0, 2, 5}, {0, 0.5f, 0});
  scene::Camera there = camera;
  there.position += offset;
  HardScene s{std::make_shared<const scene::Scene>(std::move(moved)), there, 3, 64};
  s.bound = 10.0;
  s.size = 64;
  s.twin = std::make_shared<const Twin>(Twin{here, camera});
  return s;
}

HardScene afterAJump(double metres) { return afterALamp(metres, 32); }

HardScene afterAResize(double factor) { return afterALamp(8.0, static_cast<uint32_t>(32.0 * std::sqrt(factor))); }

HardScene timeStep(double seconds) {
  HardScene s{planeAndLamp(8.0), above(0.0, 0.0f)};
  s.truth = 0.5;
  s.tick_seconds = seconds;
  return s;
}

}  // namespace helio::test
