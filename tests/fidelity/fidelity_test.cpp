// Reference mode beside another renderer's pictures, where these are: in HELIOGRAPH_REFERENCES, or beside the checkout.
// What is measured in full is `helio-bench fidelity`; here few samples show whether a factor is wrong.
#include <gmock/gmock.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench/accumulation.h"
#include "scene/spec.h"
#include "support/stage.h"

namespace helio::test {
namespace {

namespace fs = std::filesystem;

struct Expectation {
  const char* name;
  uint32_t samples;
  double tolerance;  ///< of the mean in each channel, relative
};

// furnace_metal: the other renderer's shadowing is separable Smith, ours height-correlated: 0.1 % apart in this
// picture's mean.
constexpr Expectation kExpectations[] = {{"calib_emissive", 4, 0.002},     {"calib_gradient", 16, 0.002},
                                         {"calib_plane_sky", 4, 0.002},    {"calib_plane_sun", 4, 0.002},
                                         {"calib_plane_sun60", 16, 0.002}, {"furnace_sphere", 8, 0.002},
                                         {"furnace_metal", 16, 0.01},      {"cornell", 16, 0.01}};

fs::path folder() {
  const char* chosen = std::getenv("HELIOGRAPH_REFERENCES");
  return chosen ? fs::path(chosen) : fs::path(HELIOGRAPH_SOURCE_DIR) / "../shared/references";
}

std::vector<Expectation> present() {
  std::vector<Expectation> list;
  for (const Expectation& e : kExpectations)
    if (fs::exists(folder() / (std::string(e.name) + ".ref.pfm"))) list.push_back(e);
  return list;
}

class FidelityTest : public testing::TestWithParam<Expectation> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(FidelityTest);

TEST_P(FidelityTest, MeansAgree) {
  const fs::path file = folder() / GetParam().name;
  const auto spec = scene::loadSpec(file.string() + ".json");
  ASSERT_TRUE(spec) << spec.error().message;
  const auto reference = bench::readPfm(file.string() + ".ref.pfm");
  ASSERT_TRUE(reference) << reference.error().message;
  auto run =
      bench::Accumulation::start(renderer(), spec->scene, spec->scene->cameras.front(), bench::specSettings(*spec));
  ASSERT_TRUE(run) << run.error().message;
  const auto grown = (*run)->growTo(GetParam().samples);
  ASSERT_TRUE(grown) << grown.error().message;
  EXPECT_EQ((*run)->nonfinite(), 0u);
  const glm::dvec3 seen = bench::mean((*run)->image()), truth = bench::mean(*reference);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], truth[c], GetParam().tolerance * truth[c]) << "channel " << c;
}

INSTANTIATE_TEST_SUITE_P(References, FidelityTest, testing::ValuesIn(present()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(Spec, SaysWhatIsWrong) {
  const auto error = [](const std::string& text) {
    const std::string file = testing::TempDir() + "spec_test.json";
    std::ofstream(file) << text;
    const auto spec = scene::loadSpec(file);
    return spec ? std::string("none") : spec.error().message;
  };
  const std::string start = R"({"name": "x", "gltf": null, "width": 8, "height": 8, "spp": 1, "max_bounces": 0, )";
  const std::string sky = R"("suns": [], "sky": {"type": "constant", "radiance": [1, 1, 1]}, )";
  const std::string camera = R"("camera": {"position": [0, 0, 1], "target": [0, 0, 0], "vfov_deg": 40}})";
  EXPECT_EQ(error(start + sky + camera), "none");
  EXPECT_THAT(error("{"), testing::HasSubstr("is no JSON"));
  EXPECT_THAT(error("{}"), testing::HasSubstr("name is missing"));
  EXPECT_THAT(error(start + sky + R"("camera": {"position": [0, 0], "target": [0, 0, 0], "vfov_deg": 40}})"),
              testing::HasSubstr("position is not a list of three numbers"));
  EXPECT_THAT(error(start + sky + R"("camera": {"position": [0, 0, 0], "target": [0, 0, 0], "vfov_deg": 40}})"),
              testing::HasSubstr("looks nowhere"));
  EXPECT_THAT(error(start + R"("suns": [{}, {}], "sky": {"type": "constant", "radiance": [1, 1, 1]}, )" + camera),
              testing::HasSubstr("one sun is supported"));
  EXPECT_THAT(error(start + R"("suns": [], "sky": {"type": "clouds"}, )" + camera),
              testing::HasSubstr("give constant or gradient"));
  EXPECT_THAT(scene::loadSpec("nowhere.json").error().message, testing::HasSubstr("there is no file nowhere.json"));
}

}  // namespace
}  // namespace helio::test
