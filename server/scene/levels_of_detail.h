// Levels of detail: coarser triangles over the vertices that a mesh has.
#pragma once

#include "scene/scene.h"

namespace helio::scene {

/// Whether coarser triangles may reach across seams of texture coordinates and creases of normals. `keep`: never; right
/// where textures were unwrapped. `cross`: where nothing else gets coarser; right where texture coordinates are metres
/// along planes, so that a triangle across a seam shows its texture a little stretched and no other part of it.
enum class Seams { keep, cross };

/// Levels beside the finest, at most.
inline constexpr size_t kMostCoarserLevels = 3;
/// Triangles below which a mesh is left as it is.
inline constexpr size_t kFewestTrianglesForLevels = 64;
/// A level has at most this share of the one before it.
inline constexpr double kLevelShare = 0.7;

/// Fills `mesh.levels`, each with about a third of the triangles of the one before it where the shape allows that, by
/// quadric error metrics, and by clustering where that ends [meshoptimizer]. Levels use the mesh's own vertices, so
/// texture coordinates, skins and morph targets are theirs too. What shines or is cut out by a mask keeps its triangles
/// at every level: light sampling and masks know the finest only. The mesh itself stays as it is. Deterministic for one
/// version of the library.
void makeLevels(Mesh& mesh, const std::vector<Material>& materials, Seams seams);

/// The same for a tile of a larger surface, whose materials neither shine nor are cut out by masks: its outline stays
/// as it is, so that neighbours meet whatever level each has, and no gap opens between its submeshes.
void makeTileLevels(Mesh& mesh);

/// The mesh's vertices so that each level's lie before those that only finer levels use: `order[i]` is the i-th one.
/// Empty: as they are, for there are no levels.
std::vector<uint32_t> coarsestFirst(const Mesh& mesh);

}  // namespace helio::scene
