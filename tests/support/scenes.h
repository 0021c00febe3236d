// Scenes of a few lines, whose light is known.
#pragma once

#include "scene/scene.h"

namespace helio::test {

/// Collects prefabs and placements; build() finishes the meshes. Without anything else: no sun, a black sky.
class SceneBuilder {
 public:
  SceneBuilder();

  uint32_t material(const scene::Material& material);
  uint32_t texture(scene::Texture texture);
  /// A prefab with one mesh of one material; returns its index.
  uint32_t prefab(const std::string& name, scene::Mesh mesh, uint32_t material);
  void place(uint32_t prefab, const glm::mat4x3& transform = glm::mat4x3(1.0f));
  scene::Environment& environment() { return scene_.environment; }
  scene::ScenePtr build();

 private:
  scene::Scene scene_;
};

/// Lambert of an albedo, and of a radiance.
scene::Material lambert(const glm::vec3& albedo, const glm::vec3& emission = glm::vec3(0.0f));
scene::Material metal(const glm::vec3& color, float roughness);

/// Centred at the origin, facing +y, `size` metres wide.
scene::Mesh quad(float size);
/// Unit sphere of 2 * rings * rings triangles about, with smooth normals.
scene::Mesh sphere(uint32_t rings);
/// Cube of edge 1 around the origin.
scene::Mesh cube();

/// Scale, then move.
glm::mat4x3 at(const glm::vec3& position, float scale = 1.0f);
scene::Camera lookAt(const glm::vec3& from, const glm::vec3& to, float vfov = 0.8f);

/// A patch of everything: a plane, cubes, a mirror sphere, a textured and normal-mapped cube, a lamp, sun and sky.
scene::ScenePtr stillLife();

/// A room of coloured walls, open towards +z under a black sky: two lamps, a box, balls of rough metal. `brightness`
/// scales the lamps.
scene::ScenePtr lampRoom(float brightness = 1.0f);
/// A ground under a wide sun and a sky gradient: a mirror, metals, coated and plain boxes, a lamp. No textures.
scene::ScenePtr sunlitPatch();

}  // namespace helio::test
