// What a mirror shows is followed and filtered as if it stood behind the mirror: against a twin of the scene in which
// it does.
#include <array>

#include "denoise/pictures.h"

namespace helio::test {
namespace {

using render::Denoiser;
using render::Inspect;
using render::Primary;

/// The mirror fills the view, along z = 0, and shows what is behind the camera: a wall, a box, and one that drives by.
/// In the twin they stand behind where the mirror was.
scene::ScenePtr hall(bool twin) {
  SceneBuilder b;
  const float side = twin ? -1.0f : 1.0f;
  scene::Texture checks{"checks", 8, 8, {}, true};
  for (uint32_t i = 0; i < 64; ++i) {
    const uint8_t c = (i + i / 8) % 2 ? 200 : 70;
    checks.rgba.insert(checks.rgba.end(), {c, 150, 90, 255});
  }
  scene::Material textured = lambert(glm::vec3(1.0f));
  textured.base_color_texture = b.texture(checks);
  const glm::vec3 X(1, 0, 0), Y(0, 1, 0), Z(0, 0, 1);
  // The twin's mirror is out of sight: so both have the same effects, and need the same shaders.
  b.place(b.prefab("mirror", quad(60.0f), b.material(metal(glm::vec3(1.0f), 0.0f))),
          {X, Z, -Y, {0, 0, twin ? 500.0f : 0.0f}});
  b.place(b.prefab("wall", quad(7.0f), b.material(textured)), {X, -side * Z, side * Y, {0, 0, side * 9.0f}});
  const uint32_t box = b.prefab("box", cube(), b.material(lambert({0.8f, 0.4f, 0.2f})));
  b.place(box, at({-1.2f, 0.3f, side * 6.0f}, 1.2f));
  b.place(box, at({1.1f, -0.5f, side * 7.5f}, 1.4f));
  b.environment().sky = {{0.6f, 0.7f, 1.0f}, {0.5f, 0.45f, 0.4f}};
  scene::Scene made = *b.build();
  made.routes = {scene::Route({{-3.0f, 1.4f, side * 6.5f},
                               {3.0f, 1.4f, side * 6.5f},
                               {3.0f, 1.4f, side * 20.0f},
                               {-3.0f, 1.4f, side * 20.0f}})};
  scene::Placement driving = made.placements.back();
  driving.route = 0;
  driving.route_start = 2.5f;
  driving.route_speed = 9.0f;
  driving.transform = made.routes[0].at(2.5);
  made.placements.push_back(driving);
  return std::make_shared<const scene::Scene>(std::move(made));
}

scene::Camera camera(float x) { return lookAt({x, 0.2f, 4.0f}, {0.5f * x, 0, 0}, 0.7f); }

TEST(Mirror, MotionIsThatOfWhatItShows) {
  for (const Primary primary : {Primary::traced, Primary::raster}) {
    std::array<render::Frame, 2> frames;
    for (const bool twin : {false, true}) {
      Stage stage(hall(twin));
      stage.setStep(0.05);
      render::ViewSettings settings = live(Denoiser::svgf, primary);
      settings.inspect = Inspect::motion;
      stage.tick(camera(0.0f), settings);
      frames[twin] = stage.tick(camera(0.03f), settings);
    }
    size_t wrong = 0, moves = 0;
    const size_t texels = frames[0].radiance.size() / 3;
    for (size_t i = 0; i < texels; ++i) {
      const float* mirrored = &frames[0].radiance[3 * i];
      const float* behind = &frames[1].radiance[3 * i];
      bool alike = true;
      for (int c = 0; c < 3; ++c)
        alike = alike && std::abs(mirrored[c] - behind[c]) < 0.01f + 0.01f * std::abs(behind[c]);
      wrong += !alike;
      moves += std::abs(behind[0]) > 1.5f;
    }
    EXPECT_LT(wrong, texels / 50);   // edges: a ray that meets another surface in one of the two
    EXPECT_GT(moves, texels / 200);  // what drives by
  }
}

TEST(Mirror, WhatItShowsIsFilteredAsIfItWereSeenItself) {
  std::array<double, 2> gain{};
  for (const bool twin : {false, true}) {
    const scene::ScenePtr scene = hall(twin);
    const scene::Camera eye = camera(0.0f);
    render::ViewSettings raw = live(Denoiser::none), settings = live(Denoiser::svgf);
    raw.taa = settings.taa = true;
    Stage reference(scene), noisy(scene), denoised(scene);
    for (Stage* stage : {&reference, &noisy, &denoised}) stage->setStep(0.0);
    render::ViewSettings exact = referenceSettings(kPictureWidth, kPictureHeight);
    exact.bounces = 4;
    exact.samples = 64;
    const render::Frame expected = reference.accumulate(eye, exact, 8);
    raw.bounces = settings.bounces = 4;
    const double before = relativeMse(noisy.tick(eye, raw), expected);
    const render::Frame frame = denoised.accumulate(eye, settings, 8);
    gain[twin] = before / relativeMse(frame, expected);
    std::printf("%s: 1/%.1f of the raw frame's error\n", twin ? "seen itself" : "in the mirror", gain[twin]);
    showPicture(frame, twin ? "mirror_twin" : "mirror");
    showPicture(expected, twin ? "mirror_twin_truth" : "mirror_truth");
  }
  EXPECT_GT(gain[false], 0.5 * gain[true]);
  EXPECT_GT(gain[false], 8.0);
}

}  // namespace
}  // namespace helio::test
