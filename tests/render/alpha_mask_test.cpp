// Alpha masks: what is cut out is not seen, casts no shadow and sends no light.
#include <gtest/gtest.h>

#include "scene/cut_outs.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

constexpr uint32_t kStripes = 8;

/// Every other stripe along u is cut out; texels have edges.
scene::Material striped(SceneBuilder& b, scene::Material material) {
  scene::Texture stripes{"stripes", 2 * kStripes, 1, {}, true, {}};
  for (uint32_t i = 0; i < 2 * kStripes; ++i)
    stripes.rgba.insert(stripes.rgba.end(), {255, 255, 255, static_cast<uint8_t>(i % 2 ? 0 : 255)});
  stripes.sampling.nearest = true;
  material.base_color_texture = b.texture(stripes);
  material.alpha_cutoff = 0.5f;
  return material;
}

// Seen from the front, a pixel shows the plate or the sky by the stripe that it looks at, however it is found.
TEST(AlphaMask, ShowsWhatLiesBehindItsHoles) {
  SceneBuilder b;
  b.place(b.prefab("plate", quad(2.0f), b.material(striped(b, lambert(glm::vec3(0.0f))))));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  Stage stage(b.build());
  render::ViewSettings settings = referenceSettings(128, 64);
  settings.mode = render::Mode::hybrid;
  settings.bounces = 0;
  // From straight above at 1 m: 2 m of 128 pixels across, 1 m of 64 down; a stripe is 8 pixels wide.
  const scene::Camera camera{{0, 1, 0}, {0, -1, 0}, {0, 0, -1}, 2.0f * std::atan(0.5f)};
  for (const render::Primary primary : {render::Primary::raster, render::Primary::traced}) {
    settings.primary = primary;
    const render::Frame frame = Stage(b.build()).tick(camera, settings);
    uint32_t wrong = 0;
    for (uint32_t y = 0; y < 64; ++y)
      for (uint32_t x = 0; x < 128; ++x) wrong += texel(frame, x, y).x != (x / 8 % 2 ? 1.0f : 0.0f);
    EXPECT_EQ(wrong, 0u) << (primary == render::Primary::raster ? "rasterised" : "traced");
    showPicture(frame, primary == render::Primary::raster ? "mask_raster" : "mask_traced");
  }
}

// Under a wide sun the shadows of narrow stripes run together: half of the light arrives.
TEST(AlphaMask, LetsLightThroughItsHoles) {
  const auto seen = [](bool plate) {
    SceneBuilder b;
    b.place(b.prefab("ground", quad(4.0f), b.material(lambert(glm::vec3(0.8f)))));
    const uint32_t mask = b.prefab("plate", quad(4.0f), b.material(striped(b, lambert(glm::vec3(0.0f)))));
    if (plate) b.place(mask, at({0, 4, 0}));
    b.environment().sun = {{0, -1, 0}, glm::vec3(3.0f), 0.5f};
    Stage stage(b.build());
    render::ViewSettings settings = referenceSettings(32, 32);
    settings.bounces = 0;
    return mean(stage.accumulate(lookAt({0.5f, 1, 0}, {0, 0, 0}, 0.5f), settings, 64)).x;
  };
  const float open = seen(false);
  EXPECT_NEAR(seen(true), 0.5f * open, 0.02f * open);
}

// A lamp of which half is cut out lights as one of half the radiance: light sampling and scattered rays agree about it.
TEST(AlphaMask, SendsNoLightFromItsHoles) {
  const auto seen = [](bool cut, bool light_sampling) {
    SceneBuilder b;
    b.place(b.prefab("ground", quad(6.0f), b.material(lambert(glm::vec3(0.8f)))));
    const scene::Material whole = lambert(glm::vec3(0.0f), glm::vec3(cut ? 4.0f : 2.0f));
    b.place(b.prefab("lamp", quad(2.0f), b.material(cut ? striped(b, whole) : whole)), at({0, 2, 0}));
    Stage stage(b.build());
    render::ViewSettings settings = referenceSettings(32, 32);
    settings.bounces = 0;
    settings.light_sampling = light_sampling;
    return mean(stage.accumulate(lookAt({3, 1, 0}, {0, 0, 0}, 0.3f), settings, 128)).x;
  };
  const float expected = seen(false, true);
  EXPECT_NEAR(seen(true, true), expected, 0.015f * expected);
  EXPECT_NEAR(seen(true, false), expected, 0.03f * expected);
}

// Import splits a masked mesh into what is whole and what is cut; pictures must not change.
TEST(AlphaMask, SplittingChangesNothing) {
  const auto picture = [](bool split) {
    SceneBuilder b;
    scene::Texture leaf{"leaf", 8, 8, {}, true, {}};
    for (uint32_t i = 0; i < 64; ++i) {
      const float x = static_cast<float>(i % 8) - 3.5f, y = static_cast<float>(i / 8) - 3.5f;
      leaf.rgba.insert(leaf.rgba.end(), {90, 160, 50, static_cast<uint8_t>(x * x + y * y < 11.0f ? 255 : 0)});
    }
    scene::Material material = lambert(glm::vec3(1.0f));
    material.base_color_texture = b.texture(leaf);
    material.alpha_cutoff = 0.5f;
    b.place(b.prefab("ball", sphere(12), b.material(material)));
    b.place(b.prefab("ground", quad(6.0f), b.material(lambert(glm::vec3(0.6f)))), at({0, -1.01f, 0}));
    b.environment().sun = {glm::normalize(glm::vec3(0.4f, -1.0f, -0.3f)), glm::vec3(3.0f), 0.0093f};
    b.environment().sky = {glm::vec3(0.5f), glm::vec3(0.5f)};
    scene::Scene scene = *b.build();
    if (split) {
      scene::splitCutOuts(scene.meshes[0], scene.materials, scene.textures);
      EXPECT_EQ(scene.meshes[0].submeshes.size(), 2u);
      EXPECT_LT(scene.meshes[0].indices.size(), sphere(12).indices.size()) << "some triangles are cut out whole";
    }
    Stage stage(std::make_shared<scene::Scene>(scene));
    const render::Frame frame = stage.accumulate(lookAt({0, 1, 4}, {0, 0, 0}, 0.8f), referenceSettings(96, 64), 16);
    showPicture(frame, split ? "mask_split" : "mask_unsplit");
    return frame.radiance;
  };
  const std::vector<float> whole = picture(false), split = picture(true);
  size_t different = 0;
  for (size_t i = 0; i < whole.size(); ++i) different += std::abs(whole[i] - split[i]) > 1e-4f;
  EXPECT_LE(different, whole.size() / 500);  // hits on edges between triangles
}

}  // namespace
}  // namespace helio::test
