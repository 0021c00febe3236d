#include "service/price_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace helio::service {
namespace {

using Json = nlohmann::json;

/// The point of the axis `preset` with this name, or null.
const Json* pointOf(const Json& document, const std::string& preset) {
  for (const Json& point : document.at("points"))
    if (point.at("axis") == "preset" && point.at("name") == preset) return &point;
  return nullptr;
}

render::Price priceOf(const Json& point) {
  render::FrameStats frame;
  for (const auto& [pass, times] : point.at("passes").items())
    frame.passes.push_back({pass, times.at("median_ms").get<double>()});
  return {render::scalingMs(frame), point.at("variance").get<double>(), point.at("estimated_variance").get<double>(),
          std::max(0.0, point.at("bias").get<double>())};  // its estimate lies around 0 where there is none
}

}  // namespace

Result<render::PriceList> readPriceList(const std::filesystem::path& file) {
  const std::string name = file.string();
  const auto wrong = [&](const std::string& what) {
    return invalid(
        "price-list", name,
        name + " is no price list: " + what + "; make one with helio-bench accuracy --axis preset --out DIR");
  };
  std::ifstream stream(file);
  if (!stream) return Error{ErrorKind::not_found, "there is no file " + name, "price-list", name, {}};
  render::PriceList prices;
  try {
    const Json document = Json::parse(stream);
    if (document.at("schema") != "heliograph.bench.accuracy/1") return wrong("its schema is another one");
    prices.source =
        document.value("command", "") + ", " + document.value("device", "") + ", " + document.value("date", "");
    for (size_t rung = 0; rung < render::kRungs; ++rung) {
      const std::string preset = render::kLadder[rung].name;
      const Json* point = pointOf(document, preset);
      if (!point) return wrong("it has no point preset/" + preset);
      const render::Price price = prices.rungs[rung] = priceOf(*point);
      for (const double value : {price.scaling_ms, price.variance, price.estimated})
        if (!(value > 0.0 && std::isfinite(value))) return wrong("a price of preset/" + preset + " is not above 0");
    }
  } catch (const Json::exception& error) { return wrong(error.what()); }
  return prices;
}

}  // namespace helio::service
