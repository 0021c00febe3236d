#include "scene/catalogue.h"

namespace helio::scene {

uint32_t Catalogue::add(Mesh mesh, std::string category, bool buildable) {
  prefabs.push_back({mesh.name, std::move(category), static_cast<uint32_t>(meshes.size()), buildable});
  meshes.push_back(std::move(mesh));
  return static_cast<uint32_t>(prefabs.size() - 1);
}

Catalogue makeCatalogue() {
  Catalogue catalogue;
  catalogue.palette = makePalette();
  addHouses(catalogue);
  addLandmarks(catalogue);
  addNature(catalogue);
  addProps(catalogue);
  return catalogue;
}

}  // namespace helio::scene
