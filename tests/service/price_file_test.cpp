// A price list of the operator's own: what is read, and what is refused by name.
#include "service/price_file.h"

#include <fstream>

#include "fixture.h"

namespace helio::test {
namespace {

class PriceFileTest : public ServiceTest {
 protected:
  std::filesystem::path write(const std::string& text) {
    const auto file = folder_ / "accuracy.json";
    std::ofstream(file) << text;
    return file;
  }

  /// As helio-bench accuracy writes it; rung r costs (r + 1) ms on top of what all rungs cost.
  static std::string document(size_t rungs = render::kRungs, double variance = 0.02) {
    std::string points = R"({"axis":"spp","name":"1","variance":9,"bias":9,"passes":{}})";
    for (size_t rung = 0; rung < rungs; ++rung)
      points += std::string(R"(,{"axis":"preset","name":")") + render::kLadder[rung].name +
                R"(","bias":-0.001,"variance":)" + std::to_string(variance) +
                R"(,"estimated_variance":0.005,"passes":{"tlas":{"median_ms":7},)" + R"("path_trace":{"median_ms":)" +
                std::to_string(rung + 1) + "}}}";
    return R"({"schema":"heliograph.bench.accuracy/1","command":"helio-bench accuracy","device":"D","date":"today","points":[)" +
           points + "]}";
  }
};

TEST_F(PriceFileTest, IsWhatTheBenchmarkMeasured) {
  const auto prices = service::readPriceList(write(document()));
  ASSERT_TRUE(prices.ok()) << prices.error().message;
  EXPECT_EQ(prices->source, "helio-bench accuracy, D, today");
  for (size_t rung = 0; rung < render::kRungs; ++rung) {
    EXPECT_DOUBLE_EQ(prices->rungs[rung].scaling_ms, static_cast<double>(rung) + 1.0) << "of the passes that scale";
    EXPECT_DOUBLE_EQ(prices->variance(rung, 0.005), 0.02);
    EXPECT_EQ(prices->rungs[rung].bias, 0.0) << "what is below 0 by chance is none";
  }
}

TEST_F(PriceFileTest, WhatIsNoneIsNamed) {
  const auto refused = [&](const std::string& text, const std::string& what) {
    const auto prices = service::readPriceList(write(text));
    ASSERT_FALSE(prices.ok());
    EXPECT_EQ(prices.error().field, "price-list");
    EXPECT_NE(prices.error().message.find(what), std::string::npos) << prices.error().message;
    EXPECT_NE(prices.error().message.find("helio-bench accuracy --axis preset"), std::string::npos);
  };
  refused("no JSON", "parse error");
  refused(R"({"schema":"heliograph.shot/1"})", "schema");
  refused(document(render::kRungs - 1), "no point preset/finest");
  refused(document(render::kRungs, 0.0), "is not above 0");
  EXPECT_EQ(service::readPriceList(folder_ / "nowhere.json").error().kind, ErrorKind::not_found);
}

TEST_F(PriceFileTest, IsWhatTheServerFollows) {
  const auto file = write(document(render::kRungs, 0.05));
  restart([&](service::ServerConfig& config) { config.price_list = file; });
  makeWorld("city");
  renderer_.setCostOfPaths(0.1);
  Viewer viewer(*viewers_, "city", 64, 32, [](v1::Hello& hello) {
    hello.mutable_settings()->mutable_approximations()->set_denoiser(v1::DENOISER_SVGF);
  });
  EXPECT_FLOAT_EQ(viewer.frame().telemetry().error().variance(), 0.01f * 0.05f / 0.005f);
  viewer.cancel();

  service::ServerConfig config;
  config.address = "127.0.0.1:0";
  config.price_list = folder_ / "nowhere.json";
  const auto refused = service::Server::start(std::move(config), renderer_, *store::makeMemoryEditLog());
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("nowhere.json"), std::string::npos) << refused.error().message;
}

}  // namespace
}  // namespace helio::test
