#include "hard/cases.h"

#include <array>
#include <cmath>

#include "hard/histories.h"
#include "support/scenes.h"

namespace helio::test {
namespace {

using glm::vec3;

constexpr double kPi = 3.14159265358979;
constexpr float kNarrowest = 1.1e-3f;  // radians: what a camera may have
constexpr float kNarrow = 0.01f;       // radians: the picture shows one point

void unitSky(SceneBuilder& b, float radiance = 1.0f) { b.environment().sky = {vec3(radiance), vec3(radiance)}; }

float f(double v) { return static_cast<float>(v); }

/// A plane under a sky of radiance 1 shows its albedo, whatever else is hard about it.
HardScene planeUnderSky(const scene::Material& material, const scene::Camera& camera, double truth,
                        const glm::mat4x3& transform = glm::mat4x3(1.0f), float size = 100.0f) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(size), b.material(material)), transform);
  unitSky(b);
  HardScene s{b.build(), camera};
  s.truth = truth;
  return s;
}

/// A sphere of albedo 1 in a sky of radiance 1 cannot be told from it.
HardScene furnaceAt(const vec3& place, float radius) {
  SceneBuilder b;
  b.place(b.prefab("sphere", sphere(24), b.material(lambert(vec3(1.0f)))), at(place, radius));
  unitSky(b);
  HardScene s{b.build(), lookAt(place + vec3(0, 0, 4.0f * radius), place, 0.6f), 8, 16};
  s.truth = 1.0;
  s.bound = 1.001;
  return s;
}

/// E of a square lamp of side `side`, at `height` above the point below its middle: four corners' form factors
/// [Howell, catalogue of configuration factors, B-3].
double squareForm(double side, double height) {
  const double a = 0.5 * side / height, r = std::sqrt(1.0 + a * a);
  return 4.0 / (2.0 * kPi) * 2.0 * (a / r * std::atan(a / r));
}

HardScene lampAbovePlane(double side, double radiance) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(10.0f), b.material(lambert(vec3(0.5f)))));
  b.place(b.prefab("lamp", quad(f(side)), b.material(lambert(vec3(0.0f), vec3(f(radiance))))), at({0, 2, 0}));
  HardScene s{b.build(), lookAt({0, 1, 0}, {0, 0, 0}, kNarrow), 0, 64};
  s.truth = 0.5 * radiance * squareForm(side, 2.0);
  return s;
}

HardScene sunAt(double elevation_degrees) {
  const double e = elevation_degrees * kPi / 180.0;
  SceneBuilder b;
  b.place(b.prefab("plane", quad(100.0f), b.material(lambert(vec3(1.0f)))));
  b.environment().sun = {{f(std::cos(e)), f(-std::sin(e)), 0.0f}, vec3(f(kPi)), 1e-4f};
  HardScene s{b.build(), lookAt({0, 2, 0}, {0, 0, 0}, kNarrow)};
  s.truth = std::sin(e);
  return s;
}

HardScene tiltedNormals(double scale) {
  SceneBuilder b;
  scene::Texture bumps{"bumps", 16, 16, {}, false};
  for (uint32_t i = 0; i < 256; ++i) {
    const double phi = 2.399963 * i;  // golden angle: every direction
    bumps.rgba.insert(bumps.rgba.end(), {static_cast<uint8_t>(128 + 120 * std::cos(phi)),
                                         static_cast<uint8_t>(128 + 120 * std::sin(phi)), 150, 255});
  }
  scene::Material m;
  m.base_color = glm::vec4(1.0f);
  m.roughness = 0.3f;
  m.normal_texture = b.texture(bumps);
  m.normal_scale = f(scale);
  b.place(b.prefab("plane", quad(4.0f), b.material(m)));
  unitSky(b);
  return {b.build(), lookAt({0, 1, 2}, {0, 0, 0})};
}

HardScene layers(double distance) {
  SceneBuilder b;
  const uint32_t black = b.prefab("below", quad(10.0f), b.material(lambert(vec3(0.0f))));
  b.place(black, at({0, f(1.0 - distance), 0}));
  b.place(b.prefab("above", quad(10.0f), b.material(lambert(vec3(0.5f)))), at({0, 1, 0}));
  unitSky(b);
  HardScene s{b.build(), lookAt({0, 3, 0}, {0, 1, 0}, kNarrow)};
  if (distance > 0.0) s.truth = 0.5;  // coincident: either may be seen
  return s;
}

HardScene slivers(double width) {
  // A plane of strips, each a pair of slivers, with triangles of no area between them.
  scene::Mesh mesh;
  for (uint32_t i = 0; i < 200; ++i) {
    const float x = f((i - 100.0) * width), next = f((i - 99.0) * width);
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const vec3 p : {vec3(x, 0, -5), vec3(x, 0, 5), vec3(next, 0, 5), vec3(next, 0, -5)}) {
      mesh.positions.push_back(p);
      mesh.uvs.emplace_back(p.x, p.z);
    }
    for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u, 0u, 0u, 1u, 2u, 2u, 2u}) mesh.indices.push_back(first + k);
  }
  SceneBuilder b;
  b.place(b.prefab("strips", mesh, b.material(lambert(vec3(0.5f)))));
  unitSky(b);
  HardScene s{b.build(), lookAt({0, f(width * 50.0), 0}, {0, 0, 0}, kNarrow)};
  s.truth = 0.5;
  return s;
}

/// What is scaled to nothing is not there, for rays as for raster.
HardScene scaled(const vec3& scale) {
  const glm::mat4x3 m(vec3(scale.x, 0, 0), vec3(0, scale.y, 0), vec3(0, 0, scale.z), vec3(0));
  return planeUnderSky(lambert(vec3(0.5f)), lookAt({0, 1, 0}, {0, 0, 0}, kNarrow), scale.y == 0.0f ? 1.0 : 0.5, m,
                       20.0f);
}

HardScene speckOnPlane(double size) {
  SceneBuilder b;
  const uint32_t white = b.material(lambert(vec3(1.0f)));
  b.place(b.prefab("plane", quad(f(size)), white));
  b.place(b.prefab("speck", cube(), white), at({0, 0.0005f, 0}, 0.001f));
  unitSky(b);
  HardScene s{b.build(), lookAt({0.002f, 0.002f, 0.003f}, {0, 0.0005f, 0}, 0.4f), 16};
  s.truth = 1.0;
  s.bound = 1.001;
  return s;
}

HardScene facingMirrors(double bounces) {
  SceneBuilder b;
  scene::Material mirror = metal(vec3(0.9f), 0.0f);
  mirror.emission = vec3(1.0f);
  const uint32_t wall = b.prefab("wall", quad(10.0f), b.material(mirror));
  b.place(wall);
  b.place(wall, at({0, 4, 0}));
  HardScene s{b.build(), lookAt({0, 2, 0}, {0, 0, 0}, kNarrowest), static_cast<uint32_t>(bounces)};
  double sum = 0.0;
  for (int k = 0; k <= static_cast<int>(bounces) + 1; ++k) sum += std::pow(0.9, k);
  s.truth = sum;
  return s;
}

/// Albedo 1 inside a sphere of which a black lamp covers the fraction `cover`: every point sees the fraction `cover` of
/// lamp, so L = Le (1 - (1 - cover)^(B + 1)).
HardScene whiteSphere(double cover) {
  SceneBuilder b;
  scene::Mesh ball = sphere(64), cap = ball;
  ball.indices.clear();
  cap.indices.clear();
  const scene::Mesh whole = sphere(64);
  double lit = 0.0, all = 0.0;
  for (size_t i = 0; i < whole.indices.size(); i += 3) {
    vec3 p[3];
    for (size_t k = 0; k < 3; ++k) p[k] = whole.positions[whole.indices[i + k]];
    const double area = 0.5 * static_cast<double>(glm::length(glm::cross(p[1] - p[0], p[2] - p[0])));
    // A cap of height h covers h / 2 of the sphere.
    const bool lamp = (p[0].y + p[1].y + p[2].y) / 3.0f > f(1.0 - 2.0 * cover);
    auto& indices = lamp ? cap.indices : ball.indices;
    indices.insert(indices.end(), whole.indices.begin() + static_cast<long>(i),
                   whole.indices.begin() + static_cast<long>(i) + 3);
    all += area;
    if (lamp) lit += area;
  }
  b.place(b.prefab("white", ball, b.material(lambert(vec3(1.0f)))));
  b.place(b.prefab("lamp", cap, b.material(lambert(vec3(0.0f), vec3(1.0f)))));
  const uint32_t bounces = 16;
  HardScene s{b.build(), lookAt({0, 0, 0}, {0, -1, 0.3f}, 0.3f), bounces, 64};
  s.truth = 1.0 - std::pow(1.0 - lit / all, bounces + 1.0);
  return s;
}

/// A black room that sees the sky through a square hole: its far wall shows albedo E / pi.
HardScene pinholeRoom(double hole) {
  SceneBuilder b;
  const float h = f(0.5 * hole);
  const uint32_t black = b.material(lambert(vec3(0.0f)));
  scene::Mesh lid;  // four quads around the hole, 4 m wide, at y = 2
  for (const auto& [x0, x1, z0, z1] :
       {std::array{-2.0f, -h, -2.0f, 2.0f}, {h, 2.0f, -2.0f, 2.0f}, {-h, h, -2.0f, -h}, {-h, h, h, 2.0f}}) {
    const auto first = static_cast<uint32_t>(lid.positions.size());
    for (const vec3 p : {vec3(x0, 0, z0), vec3(x0, 0, z1), vec3(x1, 0, z1), vec3(x1, 0, z0)}) {
      lid.positions.push_back(p);
      lid.uvs.emplace_back(p.x, p.z);
    }
    for (uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u}) lid.indices.push_back(first + k);
  }
  b.place(b.prefab("lid", lid, black), at({0, 2, 0}));
  const uint32_t side = b.prefab("side", quad(4.0f), black);
  for (const vec3 n : {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 0, 1), vec3(0, 0, -1)}) {
    const vec3 t = glm::cross(n, vec3(0, 1, 0));
    b.place(side, glm::mat4x3(t, n, vec3(0, 1, 0), -2.0f * n));
  }
  b.place(b.prefab("wall", quad(4.0f), b.material(lambert(vec3(1.0f)))), at({0, -2, 0}));
  const double sky = 1.0 / squareForm(hole, 4.0);  // so that the wall shows radiance 1
  unitSky(b, f(sky));
  HardScene s{b.build(), lookAt({0, 0, 0}, {0, -2, 0}, kNarrow), 0, 1024};
  s.truth = 1.0;
  s.tolerance = 0.05;  // light finds the hole by chance: 1 % takes helio-bench stability
  s.converged_samples = 8192;
  return s;
}

/// 0: inside a closed mesh without light; 1: on a surface; 2: straight up; 3: at a corner of a triangle.
HardScene oddCamera(double variant) {
  SceneBuilder b;
  b.place(b.prefab("cube", cube(), b.material(lambert(vec3(0.5f)))));
  unitSky(b);
  scene::Camera camera = lookAt({0, 0, 0}, {1, 0.2f, 0.1f});
  std::optional<double> truth = 0.0;
  if (variant == 1.0) camera = lookAt({0, 0.5f, 0}, {1, 2.0f, 0}, kNarrow), truth = 1.0;
  if (variant == 2.0) camera = {{0, 2, 0}, {0, 1, 0}, {0, 0, 1}, 0.5f}, truth = 1.0;
  if (variant == 3.0) camera = lookAt({0.5f, 0.5f, 0.5f}, {0, 0, 0}), truth.reset();
  HardScene s{b.build(), camera};
  s.truth = truth;
  return s;
}

/// An exact truth in every pixel, however far from the middle.
HardScene wideView(double degrees) {
  SceneBuilder b;
  b.place(b.prefab("plane", quad(1e4f), b.material(lambert(vec3(0.5f)))));
  unitSky(b);
  HardScene s{b.build(), lookAt({0, 1, 0}, {0, 0, 0}, f(degrees * kPi / 180.0))};
  s.truth = 0.5;
  return s;
}

/// 0: nothing at all; 1: no light; 2: one triangle; 3: an instance of size 0.
HardScene littleWorld(double variant) {
  SceneBuilder b;
  HardScene s{nullptr, lookAt({0, 1, 3}, {0, 0, 0}, kNarrow)};
  const uint32_t grey = b.material(lambert(vec3(0.5f)));
  if (variant >= 1.0) {
    scene::Mesh triangle;
    triangle.positions = {{-9, 0, 9}, {9, 0, 9}, {0, 0, -9}};
    triangle.uvs = {{0, 0}, {1, 0}, {0, 1}};
    triangle.indices = {0, 1, 2};
    const uint32_t prefab = b.prefab("triangle", triangle, grey);
    b.place(prefab, variant == 3.0 ? at({0, 0, 0}, 0.0f) : glm::mat4x3(1.0f));
  }
  if (variant >= 2.0) unitSky(b);
  s.truth = variant < 2.0 ? 0.0 : variant == 2.0 ? 0.5 : 1.0;
  s.scene = b.build();
  return s;
}

}  // namespace

const std::vector<HardCase>& hardCases() {
  static const std::vector<HardCase> cases{
      {"mirror",
       "roughness",
       {0.1, 0.01, 1e-3, 1e-4, 0.0},
       [](double v) {
         HardScene s = planeUnderSky(metal(vec3(1.0f), f(v)), lookAt({0, 2, 1}, {0, 0, 0}, kNarrow), 1.0);
         s.bound = 1.01;
         return s;
       }},
      {"roughest_metal",
       "degrees above the plane",
       {60, 10, 1, 0.1},
       [](double v) {
         const double e = v * kPi / 180.0;
         HardScene s = planeUnderSky(metal(vec3(1.0f), 1.0f),
                                     lookAt({0, f(std::sin(e)), f(std::cos(e))}, {0, 0, 0}, kNarrowest), 0.0);
         s.truth.reset();
         return s;
       }},
      {"grazing_view",
       "degrees above the plane",
       {10, 1, 0.1, 0.05},
       [](double v) {
         const double e = v * kPi / 180.0;
         return planeUnderSky(lambert(vec3(0.5f)), lookAt({0, f(std::sin(e)), f(std::cos(e))}, {0, 0, 0}, kNarrowest),
                              0.5);
       }},
      {"grazing_sun", "degrees above the plane", {10, 1, 0.1, 0.01}, sunAt},
      {"normals_below_the_surface", "scale of the normal map", {1, 10, 100, 1000}, tiltedNormals},
      {"layers", "metres between two planes", {1e-2, 1e-3, 1e-4, 1e-5, 0.0}, layers},
      {"slivers", "metres wide", {1e-2, 1e-3, 1e-4, 1e-5}, slivers},
      {"stretched",
       "ratio of two axes' scales",
       {1e3, 1e4, 1e5, 1e6},
       [](double v) {
         return scaled({f(v), 1, 1});
       }},
      {"flattened",
       "scale of the normal's axis",
       {1e-2, 1e-4, 1e-6, 0.0},
       [](double v) {
         return scaled({1, f(v), 1});
       }},
      {"mirrored",
       "scale",
       {-1, -10, -100, -1000},
       [](double v) {
         return scaled({f(v), 1, 1});
       }},
      {"far_away",
       "metres from the origin",
       {8, 80, 800, 8000},
       [](double v) {
         return furnaceAt({f(v), 0, f(v)}, 1.0f);
       }},
      {"tiny_sphere",
       "metres of radius",
       {1e-1, 1e-2, 1e-3, 1e-4},
       [](double v) {
         return furnaceAt({0, 0, 0}, f(v));
       }},
      {"huge_sphere",
       "metres of radius",
       {1e1, 1e2, 1e3, 1e4},
       [](double v) {
         return furnaceAt({0, 0, 0}, f(v));
       }},
      {"speck_on_plane", "metres of the plane", {10, 100, 1000, 10000}, speckOnPlane},
      {"small_lamp",
       "metres of its side",
       {1, 0.1, 0.01, 0.001},
       [](double v) { return lampAbovePlane(v, 1.0 / squareForm(v, 2.0)); }},
      {"large_lamp", "metres of its side", {1, 10, 30, 100}, [](double v) { return lampAbovePlane(v, 1.0); }},
      {"faint_lamp", "radiance", {1, 1e-2, 1e-4, 1e-6}, [](double v) { return lampAbovePlane(1.0, v); }},
      {"bright_lamp", "radiance", {1e3, 1e5, 1e7, 1e9}, [](double v) { return lampAbovePlane(1.0, v); }},
      {"facing_mirrors", "bounces", {3, 8, 16, 32}, facingMirrors},
      {"white_sphere", "part that shines", {0.5, 0.2, 0.1, 0.05}, whiteSphere},
      {"pinhole_room", "metres of the hole", {2, 1, 0.5, 0.25}, pinholeRoom},
      {"odd_camera", "inside a cube, on it, straight up, at a corner", {0, 1, 2, 3}, oddCamera, true},
      {"little_world", "nothing, no light, one triangle, of size 0", {0, 1, 2, 3}, littleWorld, true},
      {"same_far_away", "metres from the origin", {8, 80, 800, 8000}, stillLifeAt},
      {"after_a_jump", "metres from a lamp of radiance 1000", {8, 80, 800, 8000}, afterAJump},
      {"after_a_resize", "times as many pixels before", {4, 16, 64, 256}, afterAResize},
      {"time_step", "seconds a tick", {0, 0.01, 1, 10}, timeStep},
      {"wide_view", "degrees from top to bottom", {60, 120, 160, 177}, wideView},
  };
  return cases;
}

}  // namespace helio::test
