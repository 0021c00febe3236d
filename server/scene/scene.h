// What there is to see: meshes, materials, textures, prefabs, placements, sun, sky and named cameras.
// Knows no Vulkan. Right-handed, y up, metres; colour linear Rec. 709; radiance in W/(sr m^2).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "scene/animation.h"

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

/// What a texture shows beyond its edges.
enum class Wrap : uint8_t { repeat, mirrored_repeat, clamp };

/// How a texture is read. Seen from afar it is always filtered.
struct Sampling {
  bool nearest = false;  ///< seen closely, texels have edges
  Wrap u = Wrap::repeat;
  Wrap v = Wrap::repeat;
  // The linter takes what the compiler makes of this for a null pointer.
  friend auto operator<=>(const Sampling&, const Sampling&) = default;  // NOLINT(modernize-use-nullptr)
};

/// 8-bit RGBA, rows top-down. `srgb`: RGB is sRGB-encoded (base colour, emissive); false: linear (normal, roughness).
struct Texture {
  std::string name;
  uint32_t width = 0;
  uint32_t height = 0;
  std::vector<uint8_t> rgba;  ///< width * height * 4 bytes
  bool srgb = true;
  Sampling sampling{};
};

/// The textures of a material, in the order of Material::uv_channel.
enum class TextureSlot : uint32_t { base_color, normal, metallic_roughness, emissive, specular, specular_color };
inline constexpr size_t kTextureSlots = 6;

/// glTF metallic-roughness with KHR_materials_ior, _specular and _unlit. Texture fields index Scene::textures or are
/// kNone.
struct Material {
  std::string name;
  glm::vec4 base_color{1.0f};  ///< linear, [0, 1]
  float alpha_cutoff = 0.0f;   ///< there is no surface where the base colour's alpha is below it; 0: all is opaque
  float metallic = 0.0f;       ///< [0, 1]
  float roughness = 1.0f;      ///< perceptual, [0, 1]; alpha = roughness^2
  glm::vec3 emission{0.0f};    ///< radiance of both faces: emissiveFactor * emissiveStrength
  float normal_scale = 1.0f;
  uint32_t base_color_texture = kNone;
  uint32_t normal_texture = kNone;
  uint32_t metallic_roughness_texture = kNone;  ///< G roughness, B metallic
  uint32_t emissive_texture = kNone;
  float ior = 1.5f;                         ///< of a dielectric: 0 (reflects all) or 1 and more
  float specular = 1.0f;                    ///< weight of a dielectric's reflection, [0, 1]
  glm::vec3 specular_color{1.0f};           ///< of a dielectric's reflection along the normal, linear, 0 or more
  uint32_t specular_texture = kNone;        ///< A multiplies `specular`
  uint32_t specular_color_texture = kNone;  ///< RGB multiplies `specular_color`
  /// Which of the mesh's channels of texture coordinates each slot reads: 0 is Mesh::uvs, k is Mesh::more_uvs[k - 1].
  /// The emissive slot reads channel 0, for light sampling knows no other.
  std::array<uint8_t, kTextureSlots> uv_channel{};
  bool lambert =
      false;  ///< two-sided Lambert of base_color, no specular (the `lambert` convention of reference images)
  /// Shines with base_color from both faces, whatever light there is, and reflects nothing. Casts shadows; lights other
  /// surfaces where their scattered rays find it, but is no lamp: light sampling does not look for it.
  bool unlit = false;

  bool masked() const { return alpha_cutoff > 0.0f; }
  uint8_t channel(TextureSlot slot) const { return uv_channel[static_cast<size_t>(slot)]; }
  /// Whether a dielectric part reflects otherwise than at ior 1.5.
  bool hasOwnSpecular() const {
    return !lambert && !unlit &&
           (ior != 1.5f || specular != 1.0f || specular_color != glm::vec3(1.0f) || specular_texture != kNone ||
            specular_color_texture != kNone);
  }
};

/// A range of a mesh's triangles with one material. `first_index` is a multiple of 3.
struct Submesh {
  uint32_t first_index = 0;
  uint32_t index_count = 0;
  uint32_t material = 0;
  bool whole = false;  ///< of a masked material: its mask cuts nothing out of these triangles (scene/cut_outs.h)
};

/// Coarser triangles of a mesh, over its vertices (scene/levels_of_detail.h).
struct MeshLevel {
  std::vector<uint32_t> indices;
  std::vector<Submesh> submeshes;  ///< as the mesh's, in their order; some may be empty
  float error = 0.0f;              ///< metres that its surface may be off
};

/// Indexed triangles, counter-clockwise is front. All attribute arrays have positions.size() entries after finish(),
/// but for `colors`, which may be empty.
struct Mesh {
  std::string name;
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;   ///< unit length
  std::vector<glm::vec4> tangents;  ///< unit xyz, w = handedness (+1 or -1)
  std::vector<glm::vec2> uvs;
  std::vector<std::vector<glm::vec2>> more_uvs;  ///< further channels of texture coordinates, at most kTextureSlots - 1
  std::vector<glm::vec4> colors;                 ///< linear, [0, 1]: multiply the base colour; empty: white
  std::vector<uint32_t> indices;
  std::vector<Submesh> submeshes;
  std::vector<MeshLevel> levels;           ///< ever coarser ones; the mesh itself is the finest, level 0
  std::vector<VertexSkin> skin;            ///< of skinned meshes: one a vertex; else empty
  std::vector<MorphTarget> morph_targets;  ///< as many as its rig has weights
  /// Of buildings fitted to the ground, metres: what lies at or below 0 follows the height of the ground under it, what
  /// lies at this height and above stays; between them the shift fades. 0: stands as it is.
  float fit_height = 0.0f;
  Aabb bounds;  ///< of what deforms: over all of its poses

  /// Its instances have shapes of their own, and so BLASes of their own.
  bool deforms() const { return !skin.empty() || !morph_targets.empty() || fit_height > 0.0f; }

  /// Computes what is missing (normals: area weighted; tangents: from uv, or any frame), and the bounds.
  void finish();
};

/// What can be placed: one mesh under a name. Every instance of it is one entry of the acceleration structure.
struct Prefab {
  std::string name;      ///< unique in the scene, what clients say: "house_03", "tree_birch"
  std::string category;  ///< "house", "tree", "lamp", "square", "terrain", "model", ...
  uint32_t mesh = 0;
  bool buildable = true;  ///< users may build it (the terrain may not be built twice)
  uint32_t rig = kNone;
  uint32_t clip = 0;          ///< of the rig: what instances play that stand
  uint32_t travel_clip = 0;   ///< of the rig: what those on a route play
  float travel_speed = 1.0f;  ///< metres a second for which the travel clip was made: so feet do not slide
  uint32_t node = kNone;      ///< a rigid mesh: the node of the rig that carries it; kNone: the mesh itself deforms
  /// Instances begin the clip each at a time of its own, so that a crowd is not in step.
  bool out_of_step = false;
};

/// A prefab at a place. Columns of `transform`: x, y, z axes and translation.
struct Placement {
  uint32_t prefab = 0;
  glm::mat4x3 transform{1.0f};
  /// Its way for as long as nobody moves it; `transform` is where it is at time 0.
  uint32_t route = kNone;
  float route_start = 0.0f;  ///< metres along it at time 0
  float route_speed = 0.0f;  ///< metres a second, of either sign
};

/// The ground's height on a square lattice; between four samples linear on two triangles, which share the diagonal from
/// low x, low z to high x, high z. Beyond the lattice its border goes on.
struct HeightGrid {
  glm::vec2 origin{0.0f};      ///< metres, x and z of the first sample
  float spacing = 1.0f;        ///< metres
  uint32_t columns = 0;        ///< along x
  std::vector<float> heights;  ///< metres, rows of z

  float height(const glm::vec2& xz) const;
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

/// A light without extent, as KHR_lights_punctual has it.
struct PunctualLight {
  enum class Type : uint32_t { directional, point, spot };
  std::string name;
  Type type = Type::point;
  glm::vec3 position{0.0f};                              ///< not of a directional light
  glm::vec3 direction{0.0f, 0.0f, -1.0f};                ///< unit, the way light travels; not of a point light
  glm::vec3 color{1.0f};                                 ///< linear, [0, 1]
  float intensity = 1.0f;                                ///< directional: lux; point and spot: candela
  float range = std::numeric_limits<float>::infinity();  ///< metres, beyond it nothing arrives; above 0
  float inner_cone = 0.0f;                               ///< radians from the axis where a spot begins to fade
  float outer_cone = 0.78539816f;                        ///< radians from the axis where it ends, (inner, pi / 2]
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
  std::vector<PunctualLight> lights;
  std::vector<Rig> rigs;
  std::vector<Route> routes;
  HeightGrid ground;  ///< empty: no mesh is fitted to it
  Environment environment;
  std::vector<NamedCamera> cameras;  ///< at least one

  Aabb bounds() const;                                 ///< of all placements
  uint32_t findPrefab(const std::string& name) const;  ///< index or kNone
};

using ScenePtr = std::shared_ptr<const Scene>;

}  // namespace helio::scene
