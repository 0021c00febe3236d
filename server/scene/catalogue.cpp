#include "scene/catalogue.h"

#include "scene/deform.h"

namespace helio::scene {

uint32_t Catalogue::add(Mesh mesh, std::string category, bool buildable) {
  prefabs.push_back({mesh.name, std::move(category), static_cast<uint32_t>(meshes.size()), buildable});
  meshes.push_back(std::move(mesh));
  return static_cast<uint32_t>(prefabs.size() - 1);
}

uint32_t Catalogue::addRigged(Mesh mesh, std::string category, Rig rig) {
  mesh.bounds = boundsOverClips(mesh, rig);
  const uint32_t prefab = add(std::move(mesh), std::move(category));
  prefabs[prefab].rig = static_cast<uint32_t>(rigs.size());
  rigs.push_back(std::move(rig));
  return prefab;
}

void addFittedHouses(Catalogue& catalogue) {
  constexpr float kFitHeight = 1.2f;     // metres: walls give, windows stay
  constexpr float kSteepestDrop = 3.0f;  // metres that the ground may fall under a house
  const std::vector<HouseEntry> houses = catalogue.houses;
  catalogue.fitted.resize(catalogue.prefabs.size(), kNone);
  for (const HouseEntry& house : houses) {
    if (house.quarter != Quarter::farm || catalogue.fitted[house.prefab] != kNone) continue;
    Mesh mesh = catalogue.meshes[catalogue.prefabs[house.prefab].mesh];
    mesh.name += "_fitted";
    mesh.fit_height = kFitHeight;
    mesh.bounds.min.y -= kSteepestDrop;
    catalogue.fitted[house.prefab] = catalogue.add(std::move(mesh), "house");
  }
}

Catalogue makeCatalogue() {
  Catalogue catalogue;
  catalogue.palette = makePalette();
  addHouses(catalogue);
  addLandmarks(catalogue);
  addNature(catalogue);
  addProps(catalogue);
  addWalkers(catalogue);
  addVehicles(catalogue);
  addFittedHouses(catalogue);
  return catalogue;
}

}  // namespace helio::scene
