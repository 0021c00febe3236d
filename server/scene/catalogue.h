// Everything that the city can place: one mesh and one prefab each, with what the planner must know about it.
#pragma once

#include <string>
#include <vector>

#include "scene/palette.h"
#include "scene/scene.h"

namespace helio::scene {

/// Where a house belongs.
enum class Quarter { centre, town, suburb, farm };

struct HouseEntry {
  uint32_t prefab;
  Quarter quarter;
  float weight;  ///< how often, compared with others of the same quarter
};

struct TreeEntry {
  uint32_t prefab;
  bool conifer;
  bool garden;  ///< fit for streets and gardens too
  float weight;
};

/// Prefab indices by role.
struct Catalogue {
  Palette palette;  ///< textures and materials move into the scene when the city is done
  std::vector<Mesh> meshes;
  std::vector<Prefab> prefabs;

  std::vector<HouseEntry> houses;
  std::vector<TreeEntry> trees;
  uint32_t church = 0, town_hall = 0, glass_hall = 0, windmill = 0, gatehouse = 0;
  uint32_t lantern = 0, globe_lamp = 0;
  uint32_t fountain = 0, well = 0, statue = 0, bench = 0, planter = 0, barrel = 0, crates = 0, cart = 0, hay_bale = 0,
           signpost = 0;
  std::vector<uint32_t> stalls;
  std::vector<Rig> rigs;
  std::vector<uint32_t> walkers, vehicles;
  uint32_t turning_mill = 0;
  std::vector<uint32_t> fitted;  ///< by prefab: the same building fitted to the ground, or kNone
  uint32_t hedge = 0, fence = 0, stone_wall = 0, bush = 0;

  /// Adds a mesh and its prefab; returns the prefab's index.
  uint32_t add(Mesh mesh, std::string category, bool buildable = true);
  /// Adds a mesh with its rig, whose first clip it plays where it stands; its bounds become those of all clips.
  uint32_t addRigged(Mesh mesh, std::string category, Rig rig);
  uint32_t fittedTo(uint32_t prefab) const { return prefab < fitted.size() ? fitted[prefab] : kNone; }
  const Aabb& bounds(uint32_t prefab) const { return meshes[prefabs[prefab].mesh].bounds; }
};

void addHouses(Catalogue& catalogue);
void addLandmarks(Catalogue& catalogue);
void addNature(Catalogue& catalogue);
void addProps(Catalogue& catalogue);
void addWalkers(Catalogue& catalogue);
void addVehicles(Catalogue& catalogue);
/// Farm houses once more, fitted to the ground.
void addFittedHouses(Catalogue& catalogue);

Catalogue makeCatalogue();

}  // namespace helio::scene
