// Vehicles: rigid, they face +z and stand on y = 0.
#include "scene/catalogue.h"
#include "scene/mesh_builder.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

using glm::vec3;

/// A wheel whose axle runs along x.
void wheel(MeshBuilder& b, const Palette& p, vec3 centre, float radius, float width) {
  constexpr int kSides = 12;
  std::vector<vec3> out, in;
  for (int i = 0; i < kSides; ++i) {
    const glm::vec2 d = glm::vec2(unitVector(static_cast<double>(i) / kSides)) * radius;
    out.push_back(centre + vec3(0.5f * width, d.x, -d.y));
    in.push_back(centre + vec3(-0.5f * width, d.x, -d.y));
  }
  for (int i = 0; i < kSides; ++i) {
    const int j = (i + 1) % kSides;
    b.quad(p.tyre, in[static_cast<size_t>(i)], in[static_cast<size_t>(j)], out[static_cast<size_t>(j)],
           out[static_cast<size_t>(i)]);
  }
  b.polygon(p.iron, {out.rbegin(), out.rend()});
  b.polygon(p.iron, in);
}

void wheels(MeshBuilder& b, const Palette& p, float half_track, float front, float rear, float radius, float width) {
  for (const float x : {-half_track, half_track})
    for (const float z : {front, rear}) wheel(b, p, {x, radius, z}, radius, width);
}

/// A body whose sides lean in above the belt line.
void cabin(MeshBuilder& b, uint32_t frame, uint32_t glass, vec3 low_min, vec3 low_max, float lean, float height) {
  const float y0 = low_min.y, y1 = low_min.y + height;
  const vec3 a(low_min.x, y0, low_min.z), c(low_max.x, y0, low_max.z);
  const vec3 at(a.x + 0.6f * lean, y1, a.z + lean), ct(c.x - 0.6f * lean, y1, c.z - lean);
  b.quad(glass, {a.x, y0, c.z}, {c.x, y0, c.z}, {ct.x, y1, ct.z}, {at.x, y1, ct.z});
  b.quad(glass, {c.x, y0, a.z}, {a.x, y0, a.z}, {at.x, y1, at.z}, {ct.x, y1, at.z});
  b.quad(glass, {c.x, y0, c.z}, {c.x, y0, a.z}, {ct.x, y1, at.z}, {ct.x, y1, ct.z});
  b.quad(glass, {a.x, y0, a.z}, {a.x, y0, c.z}, {at.x, y1, ct.z}, {at.x, y1, at.z});
  b.box(frame, {at.x - 0.02f, y1, at.z - 0.02f}, {ct.x + 0.02f, y1 + 0.06f, ct.z + 0.02f});
}

Mesh car(const Palette& p, const std::string& name, uint32_t paint) {
  MeshBuilder b(name, p);
  b.box(paint, {-0.85f, 0.32f, -2.0f}, {0.85f, 0.82f, 2.0f});
  b.box(p.iron, {-0.80f, 0.22f, -1.9f}, {0.80f, 0.32f, 1.9f}, kNoTop);
  cabin(b, paint, p.pane, {-0.80f, 0.82f, -1.7f}, {0.80f, 0.82f, 0.9f}, 0.35f, 0.55f);
  for (const float x : {-0.6f, 0.6f}) {
    b.box(p.trim[0], {x - 0.16f, 0.56f, 2.0f}, {x + 0.16f, 0.70f, 2.03f}, kNoBack);
    b.box(p.fruit_red, {x - 0.14f, 0.58f, -2.03f}, {x + 0.14f, 0.70f, -2.0f}, kNoFront);
  }
  wheels(b, p, 0.78f, 1.28f, -1.28f, 0.32f, 0.2f);
  return b.build();
}

Mesh van(const Palette& p, uint32_t paint) {
  MeshBuilder b("vehicle_van", p);
  b.box(paint, {-0.95f, 0.35f, -2.5f}, {0.95f, 2.15f, 1.2f});
  b.box(paint, {-0.95f, 0.35f, 1.2f}, {0.95f, 1.05f, 2.4f}, kNoBack);
  cabin(b, paint, p.pane, {-0.93f, 1.05f, 0.9f}, {0.93f, 1.05f, 2.2f}, 0.25f, 0.95f);
  wheels(b, p, 0.85f, 1.55f, -1.6f, 0.36f, 0.22f);
  return b.build();
}

Mesh lorry(const Palette& p, uint32_t paint) {
  MeshBuilder b("vehicle_lorry", p);
  b.box(p.planks[0], {-1.1f, 0.85f, -3.4f}, {1.1f, 1.55f, 1.2f});
  b.box(p.straw, {-1.0f, 1.55f, -3.2f}, {1.0f, 1.95f, 1.0f}, kNoBottom);
  b.box(paint, {-1.0f, 0.55f, 1.3f}, {1.0f, 1.35f, 2.9f});
  cabin(b, paint, p.pane, {-0.98f, 1.35f, 1.35f}, {0.98f, 1.35f, 2.75f}, 0.18f, 0.75f);
  b.box(p.iron, {-0.5f, 0.5f, -3.4f}, {0.5f, 0.85f, 1.4f});
  wheels(b, p, 0.95f, 2.1f, -2.2f, 0.46f, 0.28f);
  return b.build();
}

}  // namespace

void addVehicles(Catalogue& catalogue) {
  const Palette& p = catalogue.palette;
  for (size_t i = 0; i < 3; ++i)
    catalogue.vehicles.push_back(
        catalogue.add(car(p, "vehicle_car_" + std::string(1, static_cast<char>('a' + i)), p.paint[i]), "vehicle"));
  catalogue.vehicles.push_back(catalogue.add(van(p, p.paint[3]), "vehicle"));
  catalogue.vehicles.push_back(catalogue.add(lorry(p, p.paint[4]), "vehicle"));
}

}  // namespace helio::scene
