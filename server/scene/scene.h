// What there is to see: meshes, materials, textures, prefabs, placements, sun, sky and named cameras.
// Knows no Vulkan. Right-handed, y up, metres; colour linear Rec. 709; radiance in W/(sr m^2).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace helio::scene {

inline constexpr uint32_t kNone = 0xffffffffu;

struct Aabb {
  glm::vec3 min{std::numeric_limits<float>::infinity()};
  glm::vec3 max{-std::numeric_limits<float>::infinity()};

  bool empty() const { return !(min.x <= max.x); }
  void grow(const glm::vec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void grow(const Aabb& b) {
    if (!b.empty()) {
      grow(b.min);
      grow(b.max);
    }
  }
  glm::vec3 centre() const { return 0.5f * (min + max); }
  glm::vec3 extent() const { return max - min; }
};

/// Bounds of `box` after the affine map `m` (columns: x, y, z axes and translation). [Arvo 1990]
Aabb transform(const Aabb& box, const glm::mat4x3& m);

/// 8-bit RGBA, rows top-down. `srgb`: RGB is sRGB-encoded (base colour, emissive); false: linear (normal, roughness).
struct Texture {
  std::string name;
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<uint8_t> rgba;  ///< width * height * 4 bytes
  bool srgb = true;
};

/// glTF metallic-roughness. Texture fields index Scene::textures or are kNone.
struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};  ///< linear, [0, 1]
  float metallic = 0.0f;       ///< [0, 1]
  float roughness = 1.0f;      ///< perceptual, [0, 1]; alpha = roughness^2
  glm::vec3 emission{0.0f};    ///< radiance of both faces: emissiveFactor * emissiveStrength
  float normal_scale = 1.0f;
  uint32_t base_color_texture = kNone;
  uint32_t normal_texture = kNone;
  uint32_t metallic_roughness_texture = kNone;  ///< G roughness, B metallic
  uint32_t emissive_texture = kNone;
  bool lambert =
      false;  ///< two-sided Lambert of base_color, no specular (the `lambert` convention of reference images)
};

/// A range of a mesh's triangles with one material. `first_index` is a multiple of 3.
struct Submesh {
  uint32_t first_index = 0;
  uint32_t index_count = 0;
  uint32_t material = 0;
};

/// Indexed triangles, counter-clockwise is front. All attribute arrays have positions.size() entries after finish().
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;   ///< unit length
  std::vector<glm::vec4> tangents;  ///< unit xyz, w = handedness (+1 or -1)
  std::vector<glm::vec2> uvs;
  std::vector<uint32_t> indices;
  std::vector<Submesh> submeshes;
  Aabb bounds;

  /// Computes what is missing (normals: area weighted; tangents: from uv, or any frame), and the bounds.
  void finish();
};

/// What can be placed: one mesh under a name. Every instance of it is one entry of the acceleration structure.
struct Prefab {
  std::string name;      ///< unique in the scene, what clients say: "house_03", "tree_birch"
  std::string category;  ///< "house", "tree", "lamp", "square", "terrain", "model", ...
  uint32_t mesh = 0;
  bool buildable = true;  ///< users may build it (the terrain may not be built twice)
};

/// A prefab at a place. Columns of `transform`: x, y, z axes and translation.
struct Placement {
  uint32_t prefab = 0;
  glm::mat4x3 transform{1.0f};
};

/// A disc of light at infinity. Not seen by camera rays, seen in reflections.
struct Sun {
  glm::vec3 direction{0.0f, -1.0f, 0.0f};  ///< unit, the way light travels (down at noon)
  glm::vec3 irradiance{0.0f};              ///< W/m^2 on a surface facing the sun; 0 = no sun
  float angular_diameter = 0.0093f;        ///< radians, full angle of the disc, (0, 0.5]
};

/// radiance(d) = mix(ground, zenith, 0.5 + 0.5 d.y); constant where both are equal.
struct Sky {
  glm::vec3 zenith{0.0f};
  glm::vec3 ground{0.0f};
};

struct Environment {
  Sun sun;
  Sky sky;
};

/// Looks along `forward`; `up` need not be perpendicular. vfov: full vertical angle in radians, (0, pi).
struct Camera {
  glm::vec3 position{0.0f};
  glm::vec3 forward{0.0f, 0.0f, -1.0f};
  glm::vec3 up{0.0f, 1.0f, 0.0f};
  float vfov = 1.0f;
};

struct NamedCamera {
  std::string name;  ///< "tilted_city"
  std::string description;
  Camera camera;
  Environment environment;  ///< the light in which this view is meant to be seen (sunset for city_at_sunset)
};

/// A whole scene. Immutable once built: worlds share it by pointer and keep their own instances.
struct Scene {
  std::string name;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Prefab> prefabs;
  std::vector<Placement> placements;  ///< the base scene
  Environment environment;
  std::vector<NamedCamera> cameras;  ///< at least one

  Aabb bounds() const;                                 ///< of all placements
  uint32_t findPrefab(const std::string& name) const;  ///< index or kNone
};

using ScenePtr = std::shared_ptr<const Scene>;

}  // namespace helio::scene
