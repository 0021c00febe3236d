// Compute shaders rasterise what the graphics pipeline does: the same surfaces in the same places, the same shadows.
#include <cmath>

#include "scene/city.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Rasteriser;

constexpr uint32_t kWidth = 192, kHeight = 108;

render::ViewSettings positions(Rasteriser rasteriser) {
  render::ViewSettings settings;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.bounces = 0;
  settings.accumulate = false;
  settings.keep_radiance = true;
  settings.inspect = render::Inspect::position;
  settings.rasteriser = rasteriser;
  return settings;
}

/// Share of the pixels whose surfaces lie apart by more than a pixel's width about, in pictures of positions.
double apart(const render::Frame& a, const render::Frame& b, const scene::Camera& camera) {
  size_t count = 0;
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) {
      const glm::vec3 p = texel(a, x, y), q = texel(b, x, y);
      const float distance = std::min(glm::distance(p, camera.position), glm::distance(q, camera.position));
      count += glm::distance(p, q) > 0.002f + 0.03f * distance;
    }
  return static_cast<double>(count) / (kWidth * kHeight);
}

void expectAlike(const scene::ScenePtr& scene, const scene::Camera& camera, const std::string& name, double most) {
  Stage stage(scene);
  stage.setStep(0.0);
  const render::Frame graphics = stage.tick(camera, positions(Rasteriser::graphics)),
                      computed = stage.tick(camera, positions(Rasteriser::compute));
  render::ViewSettings traced = positions(Rasteriser::automatic);
  traced.primary = render::Primary::traced;
  const render::Frame rays = stage.tick(camera, traced);
  showPicture(graphics, name + "_graphics");
  showPicture(computed, name + "_compute");
  EXPECT_LT(apart(computed, graphics, camera), most) << name;
  // It is no farther from what rays find than the graphics pipeline is.
  EXPECT_LT(apart(computed, rays, camera), apart(graphics, rays, camera) + 0.002) << name;
}

// Small triangles and large ones, some under the camera and behind it, masks, walkers, mills and fitted houses.
TEST(Rasteriser, ComputeShadersFindTheSurfacesOfTheGraphicsPipeline) {
  const auto city = scene::generateCity({1, 1'000, 60});
  ASSERT_TRUE(city);
  for (const scene::NamedCamera& named : (*city)->cameras) expectAlike(*city, named.camera, named.name, 0.004);
}

// Of a triangle that reaches behind the eye, the whole part before it.
TEST(Rasteriser, TrianglesBehindTheEyeAreDrawnAsFarAsTheyAreBeforeIt) {
  SceneBuilder b;
  b.place(b.prefab("ground", quad(400.0f), b.material(lambert(glm::vec3(0.5f)))));
  const uint32_t box = b.prefab("box", cube(), b.material(lambert(glm::vec3(0.7f))));
  b.place(box, at({0.0f, 0.0f, 0.0f}, 8.0f));  // the camera is within it
  for (int i = 0; i < 12; ++i)
    b.place(box, at({1.5f * std::sin(0.5f * i), 0.4f, -2.0f + 1.2f * std::cos(0.5f * i)}, 0.3f));
  const scene::ScenePtr scene = b.build();
  expectAlike(scene, lookAt({0.1f, 1.3f, 0.2f}, {0.3f, 0.6f, -3.0f}, 1.2f), "inside", 0.002);
  expectAlike(scene, lookAt({3.96f, 0.5f, 0.0f}, {-1.0f, 0.2f, 3.9f}, 1.4f), "by_the_wall", 0.002);
  expectAlike(scene, lookAt({30.0f, 0.02f, 12.0f}, {0.0f, 0.4f, 0.0f}, 0.8f), "on_the_ground", 0.002);
}

// From a picture's width to hundreds of it: where edge functions would not fit in 32 bits they are wider.
TEST(Rasteriser, LongTrianglesAreDrawnToTheirEnds) {
  SceneBuilder b;
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  const uint32_t sheet = b.prefab("sheet", quad(1.0f), b.material(lambert(glm::vec3(0.5f))));
  constexpr int kSheets = 12;
  for (int i = 0; i < kSheets; ++i) {
    // The lower left corners are seen, each a little nearer than the last; the others lie ever farther beside the
    // picture.
    const float width = 1.5f * std::exp2(0.75f * static_cast<float>(i)), step = 0.13f * static_cast<float>(i);
    const glm::vec3 right(width, 0.1f * width, 0), up(-0.05f * width, width, 0);
    const glm::vec3 corner(-1.4f + step, -0.8f + step, -2.0f + 0.02f * static_cast<float>(i));
    b.place(sheet, glm::mat4x3(right, {0, 0, 1}, -up, corner + 0.5f * right + 0.5f * up));
  }
  expectAlike(b.build(), lookAt({0, 0, 0}, {0, 0, -1}, 0.9f), "long", 0.002);
}

// Twice as many tiles as the list has room for. Stairs that rise towards the camera, each of many layers a millimetre
// apart: wherever a triangle is missing the layer behind it is seen.
TEST(Rasteriser, WhatTheListOfTilesHasNoRoomForIsDrawnToo) {
  constexpr uint32_t kStairs = 48, kLayers = 120;
  constexpr float kLayer = 0.001f, kFov = 0.8f, kSize = 60.0f;
  SceneBuilder b;
  const uint32_t sheet = b.prefab("sheet", quad(kSize), b.material(lambert(glm::vec3(0.5f))));
  uint32_t shuffled = 0;  // by a step that has no factor in common with their number
  for (uint32_t i = 0; i < kStairs * kLayers; ++i, shuffled = (shuffled + 2'557) % (kStairs * kLayers)) {
    const uint32_t stair = shuffled % kStairs, layer = shuffled / kStairs;
    const float depth = 10.0f + kLayer * static_cast<float>((kStairs - 1 - stair) * kLayers + layer);
    // Its left edge lies between two columns of pixels.
    const float ndc = 2.0f * static_cast<float>(stair) / static_cast<float>(kStairs) - 1.0f;
    const float left = ndc * depth * std::tan(0.5f * kFov) * static_cast<float>(kWidth) / static_cast<float>(kHeight);
    b.place(sheet, glm::mat4x3({1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {left + 0.5f * kSize, 0, -depth}));
  }
  Stage stage(b.build());
  const scene::Camera camera = lookAt({0, 0, 0}, {0, 0, -1}, kFov);
  const render::Frame graphics = stage.tick(camera, positions(Rasteriser::graphics)),
                      computed = stage.tick(camera, positions(Rasteriser::compute));
  size_t different = 0;
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) {
      EXPECT_LT(texel(graphics, x, y).z, -9.0f);
      different += glm::distance(texel(graphics, x, y), texel(computed, x, y)) > 0.3f * kLayer;
    }
  showPicture(computed, "no_room_for_tiles");
  EXPECT_EQ(different, 0u);
}

// Edges leave no gaps: behind a closed surface of many triangles the sky is not seen.
TEST(Rasteriser, NeighboursLeaveNoGaps) {
  SceneBuilder b;
  b.place(b.prefab("ball", sphere(48), b.material(lambert(glm::vec3(0.5f)))), at({0, 0, 0}, 3.0f));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  const scene::ScenePtr scene = b.build();
  for (const float away : {1.2f, 0.3f, 0.05f}) {
    Stage stage(scene);
    render::ViewSettings settings = positions(Rasteriser::compute);
    settings.inspect = render::Inspect::nothing;
    settings.auto_exposure = false;
    // From within: whatever is not the ball is the sky.
    const render::Frame frame = stage.tick(lookAt({1.5f - away, 0.1f, 0.0f}, {3.0f, 0.3f, 0.7f}, 1.0f), settings);
    size_t gaps = 0;
    for (uint32_t y = 0; y < kHeight; ++y)
      for (uint32_t x = 0; x < kWidth; ++x) gaps += texel(frame, x, y).x > 0.9f;
    EXPECT_EQ(gaps, 0u) << away;
  }
}

TEST(Rasteriser, ShadowMapsAreAlike) {
  const auto city = scene::generateCity({1, 1'000, 60});
  ASSERT_TRUE(city);
  render::ViewSettings settings = positions(Rasteriser::graphics);
  settings.inspect = render::Inspect::nothing;
  settings.sun_shadow = render::SunShadow::map;
  const scene::Camera& camera = (*city)->cameras.front().camera;
  // First ticks draw the same random numbers.
  const render::Frame graphics = Stage(*city).tick(camera, settings);
  settings.rasteriser = Rasteriser::compute;
  const render::Frame computed = Stage(*city).tick(camera, settings);
  showPicture(graphics, "shadows_graphics");
  showPicture(computed, "shadows_compute");
  size_t different = 0;
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) {
      const float g = texel(graphics, x, y).g, c = texel(computed, x, y).g;
      different += std::abs(g - c) > 0.2f * std::max(g, c);
    }
  EXPECT_LT(static_cast<double>(different) / (kWidth * kHeight), 0.02);
  EXPECT_LT(std::abs(mean(computed).g / mean(graphics).g - 1.0f), 0.005f);
  EXPECT_TRUE(recorded(computed, "shadow_map"));
}

}  // namespace
}  // namespace helio::test
