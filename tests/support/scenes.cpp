#include "support/scenes.h"

#include <cmath>

namespace helio::test {

SceneBuilder::SceneBuilder() {
  scene_.name = "test";
  scene_.cameras.push_back({"main", "", lookAt({0, 1, 5}, {0, 0, 0}), {}});
}

uint32_t SceneBuilder::material(const scene::Material& material) {
  scene_.materials.push_back(material);
  return static_cast<uint32_t>(scene_.materials.size() - 1);
}

uint32_t SceneBuilder::texture(scene::Texture texture) {
  scene_.textures.push_back(std::move(texture));
  return static_cast<uint32_t>(scene_.textures.size() - 1);
}

uint32_t SceneBuilder::prefab(const std::string& name, scene::Mesh mesh, uint32_t material) {
  mesh.name = name;
  mesh.submeshes = {{0, static_cast<uint32_t>(mesh.indices.size()), material}};
  mesh.finish();
  scene_.meshes.push_back(std::move(mesh));
  scene_.prefabs.push_back({name, "test", static_cast<uint32_t>(scene_.meshes.size() - 1), true});
  return static_cast<uint32_t>(scene_.prefabs.size() - 1);
}

void SceneBuilder::place(uint32_t prefab, const glm::mat4x3& transform) {
  scene_.placements.push_back({prefab, transform});
}

scene::ScenePtr SceneBuilder::build() { return std::make_shared<scene::Scene>(scene_); }

scene::Material lambert(const glm::vec3& albedo, const glm::vec3& emission) {
  scene::Material m;
  m.base_color = glm::vec4(albedo, 1.0f);
  m.emission = emission;
  m.lambert = true;
  return m;
}

scene::Material metal(const glm::vec3& color, float roughness) {
  scene::Material m;
  m.base_color = glm::vec4(color, 1.0f);
  m.metallic = 1.0f;
  m.roughness = roughness;
  return m;
}

scene::Mesh quad(float size) {
  const float h = 0.5f * size;
  scene::Mesh mesh;
  mesh.positions = {{-h, 0, -h}, {-h, 0, h}, {h, 0, h}, {h, 0, -h}};
  mesh.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

scene::Mesh sphere(uint32_t rings) {
  scene::Mesh mesh;
  const uint32_t sectors = 2 * rings;
  constexpr double kPi = 3.14159265358979;
  for (uint32_t i = 0; i <= rings; ++i)
    for (uint32_t j = 0; j <= sectors; ++j) {
      const double theta = kPi * i / rings, phi = 2.0 * kPi * j / sectors;
      const glm::vec3 p(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
      mesh.positions.push_back(p);
      mesh.normals.push_back(glm::normalize(p));
      mesh.uvs.emplace_back(static_cast<float>(j) / static_cast<float>(sectors),
                            static_cast<float>(i) / static_cast<float>(rings));
    }
  for (uint32_t i = 0; i < rings; ++i)
    for (uint32_t j = 0; j < sectors; ++j) {
      const uint32_t a = i * (sectors + 1) + j, b = a + sectors + 1;
      if (i > 0) mesh.indices.insert(mesh.indices.end(), {a, b, a + 1});
      if (i + 1 < rings) mesh.indices.insert(mesh.indices.end(), {a + 1, b, b + 1});
    }
  return mesh;
}

scene::Mesh cube() {
  scene::Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (float side : {-0.5f, 0.5f}) {
      const auto first = static_cast<uint32_t>(mesh.positions.size());
      for (const glm::vec2 corner :
           {glm::vec2(-0.5f, -0.5f), glm::vec2(0.5f, -0.5f), glm::vec2(0.5f, 0.5f), glm::vec2(-0.5f, 0.5f)}) {
        glm::vec3 p;
        p[axis] = side;
        p[(axis + 1) % 3] = side > 0 ? corner.x : -corner.x;
        p[(axis + 2) % 3] = corner.y;
        mesh.positions.push_back(p);
        mesh.uvs.push_back(corner + 0.5f);
      }
      mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
    }
  return mesh;
}

glm::mat4x3 at(const glm::vec3& position, float scale) {
  return glm::mat4x3(glm::vec3(scale, 0, 0), glm::vec3(0, scale, 0), glm::vec3(0, 0, scale), position);
}

scene::Camera lookAt(const glm::vec3& from, const glm::vec3& to, float vfov) {
  const glm::vec3 forward = glm::normalize(to - from);
  const glm::vec3 up = std::abs(forward.y) > 0.99f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
  return {from, forward, up, vfov};
}

scene::ScenePtr stillLife() {
  SceneBuilder b;
  scene::Texture checks{"checks", 8, 8, {}, true};
  scene::Texture bumps{"bumps", 8, 8, {}, false};
  for (uint32_t i = 0; i < 64; ++i) {
    const uint8_t c = (i + i / 8) % 2 ? 230 : 60;
    checks.rgba.insert(checks.rgba.end(), {c, 120, 60, 255});
    bumps.rgba.insert(bumps.rgba.end(), {static_cast<uint8_t>(i % 8 < 4 ? 160 : 96), 128, 235, 255});
  }
  scene::Material textured;
  textured.roughness = 0.6f;
  textured.base_color_texture = b.texture(checks);
  textured.normal_texture = b.texture(bumps);
  scene::Material plain;
  plain.base_color = {0.5f, 0.5f, 0.55f, 1.0f};
  b.place(b.prefab("floor", quad(20.0f), b.material(plain)));
  const uint32_t box = b.prefab("box", cube(), b.material(textured));
  b.place(box, at({-1.2f, 0.51f, 0.0f}));
  b.place(box, at({1.6f, 0.36f, -1.0f}, 0.7f));
  b.place(b.prefab("mirror", sphere(16), b.material(metal({0.9f, 0.9f, 0.9f}, 0.0f))), at({0.4f, 0.61f, 0.2f}, 0.6f));
  b.place(b.prefab("lamp", sphere(3), b.material(lambert(glm::vec3(0.0f), {40.0f, 30.0f, 15.0f}))),
          at({-0.3f, 1.6f, -1.0f}, 0.15f));
  b.environment().sun = {glm::normalize(glm::vec3(0.5f, -1.0f, -0.4f)), {9.0f, 8.5f, 7.5f}, 0.0093f};
  b.environment().sky = {{0.4f, 0.6f, 1.0f}, {0.5f, 0.45f, 0.4f}};
  return b.build();
}

scene::ScenePtr lampRoom(float brightness) {
  SceneBuilder b;
  const auto side = [](const glm::vec3& x, const glm::vec3& y, const glm::vec3& z, const glm::vec3& at) {
    return glm::mat4x3(x, y, z, at);  // a quad's axes: y is its normal
  };
  const glm::vec3 X(1, 0, 0), Y(0, 1, 0), Z(0, 0, 1);
  const uint32_t white = b.material(lambert(glm::vec3(0.7f)));
  const uint32_t wall = b.prefab("wall", quad(4.0f), white);
  b.place(wall, side(X, Y, Z, {0, 0, 0}));
  b.place(wall, side(X, -Y, -Z, {0, 4, 0}));
  b.place(wall, side(X, Z, -Y, {0, 2, -2}));
  b.place(b.prefab("red", quad(4.0f), b.material(lambert({0.7f, 0.08f, 0.06f}))), side(-Y, X, Z, {-2, 2, 0}));
  b.place(b.prefab("green", quad(4.0f), b.material(lambert({0.1f, 0.6f, 0.12f}))), side(Y, -X, Z, {2, 2, 0}));
  b.place(b.prefab("panel", quad(1.6f), b.material(lambert(glm::vec3(0.2f), brightness * glm::vec3(6.0f, 5.5f, 4.5f)))),
          at({0, 3.95f, 0}));
  b.place(b.prefab("lamp", sphere(8), b.material(lambert(glm::vec3(0.0f), brightness * glm::vec3(2.0f, 4.0f, 9.0f)))),
          at({1.2f, 0.7f, 0.9f}, 0.35f));
  scene::Material coated;
  coated.base_color = {0.6f, 0.5f, 0.2f, 1.0f};
  coated.roughness = 0.35f;
  b.place(b.prefab("box", cube(), b.material(coated)),
          side({0.9f, 0, 0.4f}, {0, 1.4f, 0}, {-0.4f, 0, 0.9f}, {-0.9f, 0.7f, -0.7f}));
  b.place(b.prefab("gold", sphere(16), b.material(metal({0.95f, 0.7f, 0.3f}, 0.3f))), at({0.5f, 0.6f, -0.6f}, 0.6f));
  b.place(b.prefab("silver", sphere(16), b.material(metal({0.9f, 0.9f, 0.95f}, 0.6f))), at({-0.2f, 0.4f, 0.8f}, 0.4f));
  return b.build();
}

scene::ScenePtr sunlitPatch() {
  SceneBuilder b;
  scene::Material coated;
  coated.base_color = {0.3f, 0.45f, 0.6f, 1.0f};
  coated.roughness = 0.5f;
  scene::Material half = metal({0.8f, 0.5f, 0.4f}, 0.4f);
  half.metallic = 0.5f;
  b.place(b.prefab("ground", quad(30.0f), b.material(lambert({0.6f, 0.5f, 0.4f}))));
  b.place(b.prefab("coated", cube(), b.material(coated)), at({-1.3f, 0.51f, 0.3f}));
  b.place(b.prefab("half", cube(), b.material(half)), at({0.1f, 0.41f, -1.4f}, 0.8f));
  b.place(b.prefab("mirror", sphere(16), b.material(metal(glm::vec3(0.9f), 0.0f))), at({0.2f, 0.51f, 0.4f}, 0.5f));
  b.place(b.prefab("metal", sphere(16), b.material(metal({0.9f, 0.7f, 0.4f}, 0.25f))), at({1.4f, 0.51f, 0.1f}, 0.5f));
  b.place(b.prefab("lamp", sphere(6), b.material(lambert(glm::vec3(0.3f), {3.0f, 2.0f, 1.0f}))),
          at({-0.6f, 1.5f, -0.6f}, 0.4f));
  b.environment().sun = {glm::normalize(glm::vec3(0.5f, -1.0f, -0.4f)), {3.0f, 2.8f, 2.5f}, 0.45f};
  b.environment().sky = {{0.4f, 0.6f, 1.0f}, {0.5f, 0.45f, 0.4f}};
  return b.build();
}

}  // namespace helio::test
