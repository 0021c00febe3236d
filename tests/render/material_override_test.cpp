// What a viewer puts in the place of all materials: each picture shows what its name says, however primary hits are
// found.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using glm::vec3;
using render::MaterialOverride;
using render::Mode;
using render::Primary;

/// Two instances of one shiny material, tilted, and one of another, unlit and level; sun, sky and automatic exposure
/// that must leave no trace where a property is shown.
struct Gallery {
  static constexpr float kRoughness = 0.3f, kMetallic = 0.6f;
  const vec3 base{0.8f, 0.5f, 0.2f}, emission{0.1f, 0.2f, 0.3f}, tilted = glm::normalize(vec3(0.6f, 0.8f, 0.0f)),
                                                                 unlit{0.25f, 0.75f, 0.5f};
  scene::ScenePtr scene;

  Gallery() {
    SceneBuilder b;
    scene::Texture bumps{"bumps", 1, 1, {220, 128, 200, 255}, false};
    scene::Material shiny;
    shiny.base_color = glm::vec4(base, 1.0f);
    shiny.roughness = kRoughness;
    shiny.metallic = kMetallic;
    shiny.emission = emission;
    const uint32_t plain = b.material(shiny);
    shiny.normal_texture = b.texture(bumps);
    const uint32_t bumpy = b.material(shiny);
    scene::Material flat;
    flat.base_color = glm::vec4(unlit, 1.0f);
    flat.unlit = true;

    scene::Mesh leaning = quad(1.0f);  // level, but its vertices' normals lean
    leaning.normals.assign(leaning.positions.size(), tilted);
    const uint32_t prefab = b.prefab("leaning", leaning, plain);
    b.place(prefab, at({-1.5f, 0, 0}));
    b.place(prefab, at({0, 0, 0}));
    b.place(b.prefab("unlit", quad(1.0f), b.material(flat)), at({1.5f, 0, 0}));
    b.place(b.prefab("bumpy", quad(1.0f), bumpy), at({3.0f, 0, 0}));
    b.environment().sun = {glm::normalize(vec3(0.5f, -1.0f, -0.4f)), vec3(9.0f), 0.01f};
    b.environment().sky = {vec3(1.0f), vec3(1.0f)};
    scene = b.build();
  }
};

constexpr uint32_t kWidth = 96, kHeight = 32;
constexpr float kVfov = 0.15f;  // 10 m above: 1.5 m are 32 pixels
/// Pixels in the middle of each instance.
constexpr uint32_t kFirst = 16, kSecond = 48, kUnlit = 80, kRow = 16;

render::Frame picture(Stage& stage, MaterialOverride materials, Mode mode, Primary primary, float x = 0.0f,
                      uint32_t samples = 8) {
  render::ViewSettings settings = referenceSettings(kWidth, kHeight);
  settings.mode = mode;
  settings.primary = primary;
  settings.materials = materials;
  settings.samples = samples;
  settings.roulette = false;
  settings.auto_exposure = true;
  return stage.tick(lookAt({x, 10, 0}, {x, 0, 0}, kVfov), settings);
}

vec3 shown(const render::Frame& frame, uint32_t x) {
  const uint8_t* p = frame.pixels->rgbx + 4 * (size_t{kRow} * frame.pixels->width + x);
  return vec3(p[0], p[1], p[2]) / 255.0f;
}

void expectNear(const vec3& seen, const vec3& expected, float tolerance, const std::string& what) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], tolerance) << what << ", channel " << c;
}

float toSrgb(float v) { return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f; }

const std::vector<std::tuple<Mode, Primary, const char*>> kWays{{Mode::reference, Primary::traced, "reference"},
                                                                {Mode::hybrid, Primary::traced, "hybrid, traced"},
                                                                {Mode::hybrid, Primary::raster, "hybrid, raster"}};

TEST(MaterialOverride, PropertiesAreShownAsTheyAre) {
  const Gallery gallery;
  Stage stage(gallery.scene);
  struct Expected {
    MaterialOverride materials;
    vec3 leaning, unlit;
  };
  const vec3 up(0.5f, 1.0f, 0.5f), rough(0.0f, Gallery::kRoughness, Gallery::kMetallic);
  const Expected cases[] = {{MaterialOverride::albedo, gallery.base, gallery.unlit},
                            {MaterialOverride::roughness_metallic, rough, vec3(0.0f, 1.0f, 0.0f)},
                            {MaterialOverride::emission, gallery.emission, gallery.unlit},
                            {MaterialOverride::normals, 0.5f + 0.5f * gallery.tilted, up},
                            {MaterialOverride::geometric_normals, up, up}};
  for (const auto& [mode, primary, way] : kWays)
    for (const Expected& c : cases) {
      const render::Frame frame = picture(stage, c.materials, mode, primary);
      const std::string what =
          render::materialOverrideNames()[static_cast<size_t>(c.materials)] + ", " + std::string(way);
      for (const uint32_t x : {kFirst, kSecond}) expectNear(texel(frame, x, kRow), c.leaning, 2e-4f, what);
      expectNear(texel(frame, kUnlit, kRow), c.unlit, 2e-4f, what + ", unlit");
      expectNear(texel(frame, kWidth / 3, kRow), vec3(0.0f), 1e-6f, what + ", between them");
      vec3 encoded = c.leaning;
      if (render::showsColor(c.materials))
        for (int k = 0; k < 3; ++k) encoded[k] = toSrgb(encoded[k]);
      expectNear(shown(frame, kFirst), encoded, 1.01f / 255.0f, what + ", as a picture");
      showPicture(frame, "override_" + render::materialOverrideNames()[static_cast<size_t>(c.materials)]);
    }
}

TEST(MaterialOverride, TextureCoordinatesRunOverTheQuad) {
  const Gallery gallery;
  Stage stage(gallery.scene);
  for (const auto& [mode, primary, way] : kWays) {
    const render::Frame frame = picture(stage, MaterialOverride::texture_coordinates, mode, primary);
    const vec3 middle = texel(frame, kSecond, kRow), aside = texel(frame, kSecond + 5, kRow);
    EXPECT_NEAR(std::abs(aside.x - middle.x) + std::abs(aside.y - middle.y), 5.0f / 32.0f * 1.5f, 0.02f) << way;
    EXPECT_EQ(middle.z, 0.0f);
  }
}

TEST(MaterialOverride, InstancesAndMaterialsHaveColours) {
  const Gallery gallery;
  Stage stage(gallery.scene);
  for (const auto& [mode, primary, way] : kWays) {
    const render::Frame instances = picture(stage, MaterialOverride::instances, mode, primary);
    EXPECT_GT(glm::distance(texel(instances, kFirst, kRow), texel(instances, kSecond, kRow)), 0.1f) << way;
    EXPECT_LT(glm::distance(texel(instances, kFirst, kRow), texel(instances, kFirst + 4, kRow)), 1e-5f) << way;
    const render::Frame materials = picture(stage, MaterialOverride::materials, mode, primary);
    EXPECT_LT(glm::distance(texel(materials, kFirst, kRow), texel(materials, kSecond, kRow)), 1e-5f) << way;
    EXPECT_GT(glm::distance(texel(materials, kFirst, kRow), texel(materials, kUnlit, kRow)), 0.1f) << way;
  }
}

// Under a sky of radiance 1 without a sun a Lambert surface shows its albedo, and what it shines with on top.
TEST(MaterialOverride, LambertAndWhiteAreLit) {
  const Gallery gallery;
  auto lit = std::make_shared<scene::Scene>(*gallery.scene);
  lit->environment.sun.irradiance = vec3(0.0f);
  for (scene::Mesh& mesh : lit->meshes) mesh.normals.assign(mesh.positions.size(), vec3(0, 1, 0));
  Stage stage(lit);
  for (const auto& [mode, primary, way] : kWays) {
    const render::Frame lambert = picture(stage, MaterialOverride::lambert, mode, primary);
    expectNear(texel(lambert, kFirst, kRow), gallery.base + gallery.emission, 2e-3f, std::string("lambert, ") + way);
    expectNear(texel(lambert, kUnlit, kRow), gallery.unlit, 2e-3f, std::string("lambert, unlit, ") + way);
    const render::Frame white = picture(stage, MaterialOverride::white, mode, primary);
    expectNear(texel(white, kFirst, kRow), vec3(0.8f) + gallery.emission, 2e-3f, std::string("white, ") + way);
    expectNear(texel(white, kUnlit, kRow), vec3(0.8f), 2e-3f, std::string("white, unlit, ") + way);
  }
}

// Normal maps bend the shading normal where it is shown and where white is lit, and not where Lambert is.
TEST(MaterialOverride, NormalMapsBelongToNormalsAndWhite) {
  const Gallery gallery;
  Stage stage(gallery.scene);
  const render::Frame normals = picture(stage, MaterialOverride::normals, Mode::hybrid, Primary::raster, 3.0f);
  EXPECT_GT(glm::distance(texel(normals, kSecond, kRow), vec3(0.5f, 1.0f, 0.5f)), 0.1f);
  const auto differs = [&](MaterialOverride materials) {
    const render::Frame bumpy = picture(stage, materials, Mode::reference, Primary::traced, 3.0f, 64);
    auto level = std::make_shared<scene::Scene>(*gallery.scene);
    for (scene::Material& m : level->materials) m.normal_texture = scene::kNone;
    Stage other(level);
    const render::Frame plain = picture(other, materials, Mode::reference, Primary::traced, 3.0f, 64);
    return glm::distance(texel(bumpy, kSecond, kRow), texel(plain, kSecond, kRow)) > 0.02f;
  };
  EXPECT_TRUE(differs(MaterialOverride::white));
  EXPECT_FALSE(differs(MaterialOverride::lambert));
}

// Accumulation does not mix what two overrides show.
TEST(MaterialOverride, AChangeStartsAgain) {
  const Gallery gallery;
  Stage stage(gallery.scene);
  for (const auto& [mode, primary, way] : kWays) {
    (void)picture(stage, MaterialOverride::none, mode, primary);
    const render::Frame frame = picture(stage, MaterialOverride::albedo, mode, primary);
    EXPECT_EQ(frame.stats.accumulated, 8u) << way;
    expectNear(texel(frame, kFirst, kRow), gallery.base, 2e-4f, way);
  }
}

TEST(MaterialOverride, NamesGoBothWays) {
  const auto& names = render::materialOverrideNames();
  ASSERT_EQ(names.size(), shared::kMaterialOverrides);
  for (size_t i = 0; i < names.size(); ++i)
    EXPECT_EQ(render::materialOverride(names[i]), static_cast<MaterialOverride>(i)) << names[i];
  EXPECT_FALSE(render::materialOverride("plastic"));
}

}  // namespace
}  // namespace helio::test
