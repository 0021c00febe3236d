#include "scene/city.h"

#include <algorithm>
#include <cmath>

#include "scene/catalogue.h"
#include "scene/city_cameras.h"
#include "scene/city_furnish.h"
#include "scene/city_plan.h"
#include "scene/city_units.h"
#include "scene/levels_of_detail.h"
#include "scene/triangle_order.h"

namespace helio::scene {
namespace {

constexpr uint32_t kFewestInstances = 1'000, kMostInstances = 1'000'000, kMostAnimated = 10'000;

/// Interleaves the bits of two cell coordinates: near in the plane, near in the order.
uint64_t mortonCode(uint32_t x, uint32_t z) {
  const auto spread = [](uint64_t v) {
    v = (v | (v << 16)) & 0x0000ffff0000ffffu;
    v = (v | (v << 8)) & 0x00ff00ff00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0f0f0f0f0fu;
    v = (v | (v << 2)) & 0x3333333333333333u;
    return (v | (v << 1)) & 0x5555555555555555u;
  };
  return spread(x) | (spread(z) << 1);
}

/// Instances near each other follow each other: acceleration structures build and trace faster over such a table.
void sortByHitbox(std::vector<Placement>& placements, const Site& site) {
  const auto code = [&](const Placement& p) {
    const glm::dvec3 position(p.transform[3]);
    const auto cell = [&](double v) {
      return static_cast<uint32_t>(std::clamp((v + site.half()) / kHitbox, 0.0, 65535.0));
    };
    return mortonCode(cell(position.x), cell(position.z));
  };
  std::vector<std::pair<uint64_t, Placement>> keyed;
  keyed.reserve(placements.size());
  for (const Placement& p : placements) keyed.push_back({code(p), p});
  std::stable_sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (size_t i = 0; i < placements.size(); ++i) placements[i] = keyed[i].second;
}

}  // namespace

Result<ScenePtr> generateCity(const CityParameters& parameters) {
  if (parameters.instances < kFewestInstances || parameters.instances > kMostInstances) {
    Error error = invalid("instances", std::to_string(parameters.instances),
                          "instances is " + std::to_string(parameters.instances) + ": ask for 1000 to 1000000");
    error.limit = "1000..1000000";
    return error;
  }
  if (parameters.animated > kMostAnimated) {
    Error error = invalid("animated", std::to_string(parameters.animated),
                          "animated is " + std::to_string(parameters.animated) + ": ask for 0 to 10000");
    error.limit = "0..10000";
    return error;
  }
  Catalogue catalogue = makeCatalogue();
  const CityPlan plan = planCity(parameters, catalogue.palette);
  Ground ground = buildGround(plan, catalogue.palette);
  const size_t mills = std::min<size_t>(parameters.animated / 100, 40), fitted = parameters.animated / 50;
  const Furnishing furnishing = furnish(plan, catalogue, parameters.instances - ground.meshes.size(), mills, fitted);
  Units units = placeUnits(plan, catalogue, parameters.animated - furnishing.animated.size());

  auto scene = std::make_shared<Scene>();
  scene->name = "city";
  scene->cameras = cityCameras(plan, furnishing);
  scene->environment = scene->cameras.front().environment;
  scene->placements.reserve(parameters.instances + parameters.animated);
  for (const Stand& stand : furnishing.stands) scene->placements.push_back({stand.prefab, stand.transform()});
  for (size_t i = 0; i < ground.meshes.size(); ++i) {
    const uint32_t prefab = catalogue.add(std::move(ground.meshes[i]), "terrain", false);
    const glm::vec3 centre(static_cast<float>(ground.centres[i].x), 0.0f, static_cast<float>(ground.centres[i].y));
    scene->placements.push_back({prefab, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, centre}});
  }
  for (const Stand& stand : furnishing.animated) scene->placements.push_back({stand.prefab, stand.transform()});
  scene->placements.insert(scene->placements.end(), units.placements.begin(), units.placements.end());
  scene->routes = std::move(units.routes);
  scene->rigs = std::move(catalogue.rigs);
  scene->ground = plan.ground.grid();
  sortByHitbox(scene->placements, plan.site);
  scene->textures = std::move(catalogue.palette.textures);
  scene->materials = std::move(catalogue.palette.materials);
  scene->meshes = std::move(catalogue.meshes);
  scene->prefabs = std::move(catalogue.prefabs);
  for (const Prefab& prefab : scene->prefabs) {
    Mesh& mesh = scene->meshes[prefab.mesh];
    orderTriangles(mesh);
    // The terrain's were made with its tiles.
    if (prefab.category != "terrain") makeLevels(mesh, scene->materials, Seams::cross);
  }
  return ScenePtr(std::move(scene));
}

}  // namespace helio::scene
