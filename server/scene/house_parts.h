// Parts that buildings are put together from. All draw into the builder's current frame; +z is outwards.
#pragma once

#include <vector>

#include "scene/mesh_builder.h"

namespace helio::scene {

inline constexpr float kBay = 2.5f;         ///< metres: width of one window axis
inline constexpr float kStorey = 3.0f;      ///< metres: floor to floor
inline constexpr float kPlinth = 0.35f;     ///< metres: ground floor above the ground
inline constexpr float kFoundation = 3.0f;  ///< metres that foundations reach below the pivot

/// A hole in a wall with a picture (window, door) at its back.
struct Opening {
  float x0, x1, y0, y1;
  uint32_t material;
};

/// A wall in the plane z = 0 with recessed openings: sorted by x, apart, within the wall.
void wallWithOpenings(MeshBuilder& b, uint32_t wall, float x0, float x1, float y0, float y1,
                      const std::vector<Opening>& openings, float recess = 0.16f);

/// A window set on the wall's face: for gables, towers and dormers.
void framedWindow(MeshBuilder& b, uint32_t frame, uint32_t glass, glm::vec2 low, glm::vec2 high);

/// A rectangle of ground plan, eaves at y, for the roofs below. Width along x, depth along z, centred.
struct RoofPlan {
  float width, depth, y;
  float rise;           ///< metres from the eaves to the ridge
  float eaves = 0.45f;  ///< overhang over the long sides
  float verge = 0.25f;  ///< overhang over the gables
};

/// Ridge along x; `wall` fills the gables.
void gableRoof(MeshBuilder& b, uint32_t roof, uint32_t wall, uint32_t trim, const RoofPlan& plan);
/// Equal slopes on four sides; a pyramid when width == depth.
void hipRoof(MeshBuilder& b, uint32_t roof, uint32_t trim, const RoofPlan& plan);
/// A steep lower storey of roof (2.4 m) under a hip of `rise`.
void mansardRoof(MeshBuilder& b, uint32_t roof, uint32_t trim, const RoofPlan& plan);
/// A parapet around a level roof.
void flatRoof(MeshBuilder& b, uint32_t roof, uint32_t wall, uint32_t trim, const RoofPlan& plan);

/// A gabled dormer facing +z with its foot at (x, y, z), reaching `depth` back into the roof.
void dormer(MeshBuilder& b, uint32_t wall, uint32_t roof, uint32_t trim, uint32_t glass, glm::vec3 foot, float depth);
void chimney(MeshBuilder& b, uint32_t brick, uint32_t trim, glm::vec3 foot, float height, float side = 0.7f);
/// A sloping canvas over a shop, against the wall z = 0.
void awning(MeshBuilder& b, uint32_t canvas, float x0, float x1, float y);
/// A moulding around a rectangular body at height y.
void stringCourse(MeshBuilder& b, uint32_t trim, float width, float depth, float y, float height, float reach);
/// The stone foot of a body, from below the ground to the ground floor.
void plinth(MeshBuilder& b, uint32_t stone, float width, float depth);

}  // namespace helio::scene
