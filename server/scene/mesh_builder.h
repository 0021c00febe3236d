// Builds a mesh of flat and rounded parts, one submesh for each material, with texture coordinates in metres.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/palette.h"
#include "scene/scene.h"

namespace helio::scene {

/// Appends one submesh for each material with its triangles' indices.
void addSubmeshes(Mesh& mesh, const std::map<uint32_t, std::vector<uint32_t>>& by_material);

/// Faces of a box() to leave out (hidden ones).
enum BoxFace : uint32_t { kNoBottom = 1, kNoTop = 2, kNoBack = 4, kNoFront = 8, kNoLeft = 16, kNoRight = 32 };

/// An icosahedron subdivided `levels` times (20 * 4^levels triangles), radii varied by `lumps` (0: none).
struct Blob {
  glm::vec3 centre;
  glm::vec3 radii;
  int levels;
  float lumps;
  uint64_t seed;
};

/// Points are given in the current frame; +y is up in every frame. Winding: counter-clockwise seen from outside.
class MeshBuilder {
 public:
  MeshBuilder(std::string name, const Palette& palette) : palette_(palette) { mesh_.name = std::move(name); }

  const Palette& palette() const { return palette_; }

  /// Frame: origin, and quarter turns counter-clockwise seen from above (1: local +z points along +x).
  void setFrame(glm::vec3 origin = glm::vec3(0.0f), int quarter_turns = 0);

  /// Flat polygon (convex); texture axes are horizontal and up the slope of its plane.
  void polygon(uint32_t material, const std::vector<glm::vec3>& points);
  void quad(uint32_t material, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d) { polygon(material, {a, b, c, d}); }
  void triangle(uint32_t material, glm::vec3 a, glm::vec3 b, glm::vec3 c) { polygon(material, {a, b, c}); }
  /// A quad that shows the whole texture once: `a` bottom left, then counter-clockwise.
  void picture(uint32_t material, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d);

  /// `omit`: BoxFace bits. Front is +z, right is +x.
  void box(uint32_t material, glm::vec3 min, glm::vec3 max, uint32_t omit = 0);
  /// Upright frustum with smooth sides; radius 0 makes a cone. Closed at the top unless the radius is 0.
  void frustum(uint32_t material, glm::vec3 base, float bottom_radius, float top_radius, float height, int sides,
               bool bottom = false);
  /// The same with flat sides, turned so that a side faces the front.
  void prism(uint32_t material, glm::vec3 base, float bottom_radius, float top_radius, float height, int sides,
             bool bottom = false);
  /// Lumpy balls that may grow into each other: what lies hidden inside another one is left out.
  void blobs(uint32_t material, const std::vector<Blob>& blobs);
  void blob(uint32_t material, const Blob& blob) { blobs(material, {blob}); }

  /// Parts that follow hang on this joint of the mesh's rig; without a call no part hangs on any.
  void hangOn(uint16_t joint);

  Mesh build();

 private:
  uint32_t vertex(glm::vec3 position, glm::vec3 normal, glm::vec2 uv);
  glm::vec3 turned(glm::vec3 v) const;
  std::vector<uint32_t>& indices(uint32_t material) { return by_material_[material]; }

  const Palette& palette_;
  Mesh mesh_;
  std::map<uint32_t, std::vector<uint32_t>> by_material_;
  bool rigged_ = false;
  uint16_t joint_ = 0;
  glm::vec3 origin_{0.0f};
  int quarter_turns_ = 0;
};

}  // namespace helio::scene
