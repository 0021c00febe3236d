// What the culling benchmark says, and how it compares pictures.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bench/culling.h"
#include "bench/image.h"

namespace helio::bench {
namespace {

using ::testing::HasSubstr;

Image gradient(uint32_t size, float contrast) {
  Image image{size, size, {}};
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x)
      for (int c = 0; c < 3; ++c)
        image.rgb.push_back(0.5f +
                            contrast * std::sin(0.5f * static_cast<float>(x)) * std::cos(0.3f * static_cast<float>(y)));
  return image;
}

TEST(Ssim, IsOneForEqualPicturesAndFallsWithTheDifference) {
  const Image truth = gradient(48, 0.4f);
  EXPECT_NEAR(ssim(truth, truth), 1.0, 1e-12);
  const double near = ssim(gradient(48, 0.38f), truth), far = ssim(gradient(48, 0.1f), truth);
  EXPECT_GT(near, 0.99);
  EXPECT_LT(far, 0.8);
  EXPECT_LT(ssim(gradient(48, -0.4f), truth), 0.0);  // the structure turned over
}

CullingReport report() {
  CullingReport report;
  report.camera = "tilted_city";
  report.instances = 1'400;
  report.animated = 400;
  CullingRun full;
  full.strategy = "full";
  full.tlas_instances = {1'400, 1'400};
  full.frame_ms = {12.5, 14.0};
  full.memory.own_blas_bytes = 3'000'000;
  full.memory.tlas_bytes = 1'000'000;
  CullingRun culled = full;
  culled.strategy = "frustum_radius";
  culled.tlas_instances = {700, 720};
  culled.composite = {0.001, 0.998};
  report.runs = {full, culled};
  return report;
}

TEST(CullingReport, JsonHasEveryFigureByStrategy) {
  const Json json = toJson(report());
  EXPECT_EQ(json["schema"], "heliograph.bench.culling/1");
  for (const char* strategy : {"full", "frustum_radius"}) {
    const Json& run = json["strategies"][strategy];
    for (const char* key : {"tlas_instances", "own_blas_count", "own_blas_in_view", "blas_triangles", "blas_ms",
                            "tlas_ms", "assemble_ms", "path_trace_ms", "shadow_ms", "primary_ms", "frame_ms"})
      EXPECT_TRUE(run[key].contains("median") && run[key].contains("p95")) << key;
    EXPECT_EQ(run["rt_memory_bytes"]["total"], 4'000'000u);
  }
  EXPECT_EQ(json["strategies"]["frustum_radius"]["tlas_instances"]["p95"], 720.0);
  EXPECT_EQ(json["strategies"]["frustum_radius"]["image_error"]["composite"]["ssim"], 0.998);
}

TEST(CullingReport, TableAndPlotNameTheStrategies) {
  EXPECT_THAT(toMarkdown(report()), HasSubstr("frustum_radius"));
  EXPECT_THAT(toMarkdown(report()), HasSubstr("12.50 (14.00)"));
  EXPECT_THAT(toSvg(report()), HasSubstr("<svg"));
  EXPECT_THAT(toSvg(report()), HasSubstr("</svg>"));
}

}  // namespace
}  // namespace helio::bench
