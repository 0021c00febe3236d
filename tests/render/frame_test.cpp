// The frame's promises: primaries agree, the same ticks give the same bytes, absent effects cost nothing, bad input is
// refused.
#include <cmath>
#include <limits>

#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using render::Mode;
using render::Primary;

render::ViewSettings live(Primary primary) {
  render::ViewSettings settings;
  settings.width = 160;
  settings.height = 90;
  settings.primary = primary;
  settings.accumulate = false;
  settings.auto_exposure = false;
  return settings;
}

/// Rasterised vertices are snapped to 1/256 of a pixel: an edge may be so far from where rays find it, in pixels.
constexpr double kEdge = 2.0 / 256.0;

const scene::Camera kCamera = lookAt({0.5f, 1.6f, 4.0f}, {0, 0.5f, 0}, 0.8f);

/// The instance and triangle that a point of the picture shows, by brute force in double precision; -1: none.
int64_t seen(const scene::Scene& scene, const scene::Camera& camera, const render::ViewSettings& settings,
             const glm::dvec2& point) {
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.forward));
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up)));
  const double tangent = std::tan(0.5 * static_cast<double>(camera.vfov));
  const glm::dvec2 size(settings.width, settings.height), ndc = 2.0 * point / size - 1.0;
  const glm::dvec3 direction =
      forward + tangent * (ndc.x * size.x / size.y * right - ndc.y * glm::cross(right, forward));
  double nearest = std::numeric_limits<double>::infinity();
  int64_t hit = -1, triangle = 0;
  for (const scene::Placement& placement : scene.placements) {
    const scene::Mesh& mesh = scene.meshes[scene.prefabs[placement.prefab].mesh];
    for (size_t i = 0; i < mesh.indices.size(); i += 3, ++triangle) {
      glm::dvec3 p[3];
      for (size_t k = 0; k < 3; ++k)
        p[k] = glm::dmat4x3(placement.transform) * glm::dvec4(mesh.positions[mesh.indices[i + k]], 1.0) -
               glm::dvec3(camera.position);
      // Cramer's rule for p0 + u e1 + v e2 = t d.
      const glm::dvec3 e1 = p[1] - p[0], e2 = p[2] - p[0];
      const double det = glm::dot(e1, glm::cross(direction, e2));
      const double u = glm::dot(-p[0], glm::cross(direction, e2)) / det;
      const double v = glm::dot(direction, glm::cross(-p[0], e1)) / det;
      const double t = glm::dot(e2, glm::cross(-p[0], e1)) / det;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < nearest) {
        nearest = t;
        hit = triangle;
      }
    }
  }
  return hit;
}

TEST(Frame, RasterisedAndTracedPrimaryHitsAgree) {
  const scene::ScenePtr scene = stillLife();
  std::vector<uint8_t> pictures[2];
  for (const Primary primary : {Primary::raster, Primary::traced}) {
    Stage stage(scene);  // a fresh view: the same seeds
    const render::Frame frame = stage.tick(kCamera, live(primary));
    pictures[primary == Primary::traced] = bytes(frame);
    showPicture(frame, primary == Primary::traced ? "primary_traced" : "primary_raster");
  }
  // Same pixel, same triangle, same random numbers: the same colour, except where an edge goes through the pixel's
  // centre and falls on either side.
  const render::ViewSettings settings = live(Primary::raster);
  size_t different = 0;
  for (size_t i = 0; i < pictures[0].size(); i += 4) {
    int most = 0;
    for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(pictures[0][i + c] - pictures[1][i + c]));
    if (most <= 4) continue;
    ++different;
    const uint32_t x = static_cast<uint32_t>(i / 4) % settings.width, y = static_cast<uint32_t>(i / 4) / settings.width;
    const glm::dvec2 centre(x + 0.5, y + 0.5);
    bool edge = false;
    for (const glm::dvec2& d : {glm::dvec2(1, 1), glm::dvec2(1, -1), glm::dvec2(-1, 1), glm::dvec2(-1, -1)})
      edge = edge || seen(*scene, kCamera, settings, centre) != seen(*scene, kCamera, settings, centre + kEdge * d);
    EXPECT_TRUE(edge) << "pixel " << x << ", " << y << " differs by " << most << " far from any edge";
  }
  EXPECT_LT(different, pictures[0].size() / 4 / 100) << "of " << pictures[0].size() / 4 << " pixels";
}

TEST(Frame, TheSameTickLogGivesTheSameBytes) {
  const scene::ScenePtr scene = stillLife();
  std::vector<std::vector<uint8_t>> runs[2];
  for (auto& run : runs) {
    Stage stage(scene);
    render::ViewSettings settings = live(Primary::raster);
    settings.accumulate = settings.auto_exposure = true;
    for (int i = 0; i < 6; ++i) {
      if (i == 2)
        stage.edit({world::Build{
            "box", {{{2.5f, 0.5f, 1.0f}, {1, 0, 0, 0}, 0.5f}, {{-2.5f, 0.5f, 1.0f}, {1, 0, 0, 0}, 0.5f}}}});
      if (i == 4) stage.edit({world::Destroy{{2}}});
      run.push_back(
          bytes(stage.tick(lookAt({0.5f + 0.1f * static_cast<float>(i / 2), 1.6f, 4.0f}, {0, 0.5f, 0}), settings)));
    }
  }
  for (size_t i = 0; i < runs[0].size(); ++i) EXPECT_EQ(runs[0][i], runs[1][i]) << "tick " << i;
  EXPECT_NE(runs[0][1], runs[0][2]) << "the edit is not seen";
}

TEST(Frame, PathsInAnyNumberOfLaunchesGiveTheSameBytes) {
  const scene::ScenePtr scene = stillLife();
  for (const bool roulette : {false, true}) {
    std::vector<uint8_t> one_launch;
    render::Rays rays;
    for (const uint32_t launches : {1u, 2u, 3u, 5u}) {
      Stage stage(scene);
      render::ViewSettings settings = live(Primary::traced);
      settings.roulette = roulette;
      settings.samples = 2;  // the second must find the queue empty
      settings.path_launches = launches;
      const render::Frame frame = stage.tick(kCamera, settings);
      if (launches == 1) {
        one_launch = bytes(frame);
        rays = frame.stats.rays;
        EXPECT_GT(rays.bounce, 0u);
      }
      EXPECT_EQ(bytes(frame), one_launch) << launches << " launches";
      EXPECT_EQ(frame.stats.rays.bounce, rays.bounce) << launches << " launches";
      EXPECT_EQ(frame.stats.rays.shadow, rays.shadow) << launches << " launches";
    }
  }
}

TEST(Frame, AReferenceImageIsAFunctionOfItsInputsAlone) {
  const scene::ScenePtr scene = stillLife();
  Stage fresh(scene), used(scene);
  const render::ViewSettings settings = referenceSettings(64, 36);
  used.accumulate(lookAt({3, 3, 3}, {0, 0, 0}), live(Primary::raster), 3);
  used.accumulate(lookAt({2, 3, 3}, {0, 0, 0}), settings, 2);
  EXPECT_EQ(bytes(fresh.accumulate(kCamera, settings, 4)), bytes(used.accumulate(kCamera, settings, 4)));
}

TEST(Frame, AbsentEffectsRecordNothing) {
  SceneBuilder b;
  const uint32_t plane = b.prefab("plane", quad(10.0f), b.material(lambert(glm::vec3(0.5f))));
  b.prefab("lamp", quad(0.5f), b.material(lambert(glm::vec3(0.0f), glm::vec3(10.0f))));
  b.place(plane);
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  Stage stage(b.build());
  const scene::Camera camera = lookAt({0, 3, 3}, {0, 0, 0});

  // No sun, nothing shines, fixed exposure, no accumulation: none of their passes, no shadow ray, no effect in the
  // telemetry.
  render::Frame frame = stage.tick(camera, live(Primary::raster));
  EXPECT_TRUE(recorded(frame, "assemble"));
  EXPECT_TRUE(recorded(frame, "path_trace"));
  for (const char* absent :
       {"emitters", "histogram", "exposure", "accumulate", "primary_traced", "log_rays", "bare_trace"})
    EXPECT_FALSE(recorded(frame, absent)) << absent;
  EXPECT_TRUE(frame.stats.effects.empty());
  EXPECT_EQ(frame.stats.rays.shadow, 0u);
  EXPECT_GT(frame.stats.rays.bounce, 0u);

  // Nothing changed: the acceleration structure is not touched.
  frame = stage.tick(camera, live(Primary::raster));
  for (const char* absent : {"instances", "assemble", "tlas"}) EXPECT_FALSE(recorded(frame, absent)) << absent;

  // A lamp is built: its effect and its pass appear with it, and go with it.
  stage.edit({world::Build{"lamp", {{{0, 2, 0}, {1, 0, 0, 0}, 1.0f}}}});
  frame = stage.tick(camera, live(Primary::raster));
  EXPECT_TRUE(recorded(frame, "emitters"));
  ASSERT_EQ(frame.stats.effects.size(), 1u);
  EXPECT_EQ(frame.stats.effects[0].name, "emissive_triangles");
  EXPECT_EQ(frame.stats.effects[0].instances, 1u);
  EXPECT_GT(frame.stats.rays.shadow, 0u);
  stage.edit({world::Destroy{{2}}});
  frame = stage.tick(camera, live(Primary::raster));
  EXPECT_FALSE(recorded(frame, "emitters"));
  EXPECT_TRUE(frame.stats.effects.empty());
  EXPECT_EQ(frame.stats.rays.shadow, 0u);
}

TEST(Frame, EditsAreSeen) {
  Stage stage(stillLife());
  const render::ViewSettings settings = referenceSettings(64, 36);
  const render::Frame before = stage.accumulate(kCamera, settings, 8);
  stage.edit({world::DestroyRegion{{1.6f, -1.0f}, 0.5f}});
  const render::Frame bare = stage.accumulate(kCamera, settings, 8);
  EXPECT_EQ(bare.stats.applied_seq, 1u);
  EXPECT_LT(bare.stats.tlas_instances, before.stats.tlas_instances);
  EXPECT_NE(bytes(before), bytes(bare));
  scene::Sun night;
  stage.edit({world::SetSun{night, false}});
  EXPECT_LT(mean(stage.accumulate(kCamera, settings, 8)).x, mean(bare).x);
}

TEST(Frame, OnlyAStillPictureIsAveraged) {
  Stage stage(stillLife());
  render::ViewSettings settings = live(Primary::raster);
  settings.accumulate = true;
  EXPECT_FALSE(recorded(stage.tick(kCamera, settings), "accumulate"));
  EXPECT_FALSE(recorded(stage.tick(lookAt({0.6f, 1.6f, 4.0f}, {0, 0.5f, 0}), settings), "accumulate"));
  const scene::Camera still = lookAt({0.7f, 1.6f, 4.0f}, {0, 0.5f, 0});
  (void)stage.tick(still, settings);
  for (uint32_t samples = 1; samples <= 3; ++samples) {
    const render::Frame frame = stage.tick(still, settings);
    EXPECT_TRUE(recorded(frame, "accumulate"));
    EXPECT_EQ(frame.stats.accumulated, samples);
  }
  stage.edit({world::Destroy{{2}}});
  EXPECT_FALSE(recorded(stage.tick(still, settings), "accumulate")) << "the world did not stand still";
}

TEST(Frame, AsManySamplesATickAsAreAllowed) {
  Stage stage(stillLife());
  render::ViewSettings settings = live(Primary::traced);
  settings.width = settings.height = 16;
  settings.samples = 64;
  const render::Frame frame = stage.tick(kCamera, settings);
  EXPECT_EQ(frame.stats.accumulated, 64u);
  EXPECT_EQ(frame.stats.rays.primary, 64u * 256u);
}

TEST(Frame, AnEmptyWorldShowsTheSky) {
  Stage stage(stillLife());
  std::vector<world::InstanceId> all;
  for (uint64_t id = 1; id <= stage.world().instanceCount(); ++id) all.push_back(id);
  stage.edit({world::Destroy{all}});
  for (const Primary primary : {Primary::raster, Primary::traced}) {
    const render::Frame frame = stage.tick(kCamera, live(primary));
    EXPECT_EQ(frame.stats.tlas_instances, 0u);
    EXPECT_EQ(frame.stats.rays.bounce, 0u);
  }
}

TEST(Frame, SeveralViewsOfOneWorldDoNotDisturbEachOther) {
  const scene::ScenePtr scene = stillLife();
  Stage alone(scene);
  const render::Frame expected = alone.tick(kCamera, live(Primary::raster));

  world::World world(scene);
  const auto handle = *renderer().addWorld(scene);
  const auto first = *renderer().addView(handle), second = *renderer().addView(handle);
  render::ViewSettings large = live(Primary::traced);
  large.width = 200;
  const render::ViewRequest requests[] = {{first, kCamera, live(Primary::raster)},
                                          {second, lookAt({-3, 2, 2}, {0, 0, 0}), large}};
  auto frames = renderer().tick(handle, world.beginTick(0.1), requests);
  ASSERT_TRUE(frames.ok()) << frames.error().message;
  EXPECT_EQ(bytes(frames->at(0)), bytes(expected));
  EXPECT_EQ(frames->at(1).pixels->width, 200u);
  EXPECT_TRUE(recorded(frames->at(0), "primary_raster"));
  EXPECT_FALSE(recorded(frames->at(0), "primary_traced"));
  EXPECT_TRUE(recorded(frames->at(1), "primary_traced"));
  // A picture outlives its view and its world.
  renderer().removeView(first);
  renderer().removeWorld(handle);
  EXPECT_EQ(bytes(frames->at(0)), bytes(expected));
}

TEST(Frame, BadInputIsRefusedByName) {
  Stage stage(stillLife());
  (void)stage.tick(kCamera, live(Primary::raster));
  scene::Camera camera = kCamera;
  camera.position.x = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(render::check(camera).error().field, "camera.position");
  camera = kCamera;
  camera.up = camera.forward;
  EXPECT_EQ(render::check(camera).error().field, "camera.up");
  camera = kCamera;
  camera.vfov = 0.0f;
  EXPECT_EQ(render::check(camera).error().field, "camera.vfov");
  for (const auto& [width, height, field] :
       {std::tuple{0u, 0u, "settings.width"}, {20000u, 20000u, "settings.width"}, {64u, 8u, "settings.height"}}) {
    render::ViewSettings settings;
    settings.width = width;
    settings.height = height;
    const auto result = render::check(settings);
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.error().field, field);
    EXPECT_EQ(result.error().kind, ErrorKind::invalid);
  }
}

TEST(Frame, AutomaticExposureBringsAnyLightToTheSamePicture) {
  double brightness[2];
  for (int i = 0; i < 2; ++i) {
    SceneBuilder b;
    b.place(b.prefab("plane", quad(100.0f), b.material(lambert(glm::vec3(0.5f)))));
    const glm::vec3 sky(i ? 1000.0f : 0.001f);
    b.environment().sky = {sky, sky};
    Stage stage(b.build());
    render::ViewSettings settings = live(Primary::raster);
    settings.auto_exposure = true;
    const std::vector<uint8_t> picture = bytes(stage.accumulate(lookAt({0, 5, 0}, {0, 0, 0}), settings, 2));
    brightness[i] = 0.0;
    for (size_t p = 0; p < picture.size(); p += 4) brightness[i] += picture[p];
    brightness[i] /= static_cast<double>(picture.size() / 4);
  }
  EXPECT_NEAR(brightness[0], brightness[1], 3.0);
  EXPECT_GT(brightness[0], 90.0);
  EXPECT_LT(brightness[0], 160.0);
}

}  // namespace
}  // namespace helio::test
