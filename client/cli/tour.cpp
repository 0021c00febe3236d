#include "cli/tour.h"

#include <algorithm>
#include <utility>

namespace helio::cli {
namespace {

constexpr const char* kSchema = "heliograph.tour/1";
constexpr uint32_t kMostBuilt = 1000;  // one step is one edit, and should be seen to happen

/// Thrown by the readers below; parseTour puts the step before it.
struct Wrong {
  std::string message;
};

template <typename T>
T number(const Json& object, const char* key, T low, T high) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) throw Wrong{std::string("\"") + key + "\" must be a number"};
  const double value = found->get<double>();
  if (!(value >= double(low) && value <= double(high)))
    throw Wrong{std::string("\"") + key + "\" is " + found->dump() + "; give " + std::to_string(low) + " to " +
                std::to_string(high)};
  return static_cast<T>(value);
}

std::string word(const Json& value, const char* key) {
  if (!value.is_string()) throw Wrong{std::string("\"") + key + "\" must be a name"};
  return value.get<std::string>();
}

Place place(const Json& object) {
  if (object.contains("ahead")) return {number(object, "ahead", 0.0f, 10'000.0f), {}};
  const auto at = object.find("at");
  if (at == object.end() || !at->is_array() || at->size() != 2 || !(*at)[0].is_number() || !(*at)[1].is_number())
    throw Wrong{"a place is \"ahead\": METRES or \"at\": [x, z]"};
  return {std::nullopt, {(*at)[0].get<float>(), (*at)[1].get<float>()}};
}

Step step(const Json& object) {
  if (!object.is_object()) throw Wrong{"must be an object"};
  Step out;
  if (object.contains("seconds")) out.seconds = number(object, "seconds", 0.0, 600.0);
  if (const auto jump = object.find("jump"); jump != object.end()) {
    out.what = Jump{word(*jump, "jump")};
  } else if (const auto fly = object.find("fly"); fly != object.end()) {
    if (!fly->is_array() || fly->size() != 2) throw Wrong{"\"fly\" takes two cameras: [from, to]"};
    out.what = Fly{word((*fly)[0], "fly"), word((*fly)[1], "fly")};
  } else if (const auto build = object.find("build"); build != object.end()) {
    out.what = BuildStep{word(*build, "build"), number(object, "count", 1u, kMostBuilt), place(object)};
  } else if (const auto destroy = object.find("destroy"); destroy != object.end()) {
    out.what = DestroyStep{place(*destroy), number(*destroy, "radius", 0.0f, 10'000.0f)};
  } else if (const auto sun = object.find("sun"); sun != object.end()) {
    out.what = SunStep{number(*sun, "elevation", -90.0, 90.0), number(*sun, "azimuth", -360.0, 360.0)};
  } else {
    throw Wrong{"is none of jump, fly, build, destroy, sun"};
  }
  return out;
}

}  // namespace

double Tour::seconds() const {
  double sum = 0;
  for (const auto& step : steps) sum += step.seconds;
  return sum;
}

void Tour::last(double wanted) {
  const double present = seconds();
  for (auto& step : steps) step.seconds = present > 0 ? step.seconds * wanted / present : wanted / double(steps.size());
}

Result<Tour> parseTour(const std::string& text) {
  const auto document = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (document.is_discarded()) return invalid("script", "", "the tour is not JSON");
  if (!document.is_object() || document.value("schema", "") != kSchema)
    return invalid("script.schema", "", std::string("the tour's \"schema\" must be \"") + kSchema + "\"");
  const auto steps = document.find("steps");
  if (steps == document.end() || !steps->is_array() || steps->empty())
    return invalid("script.steps", "", "the tour has no \"steps\"");
  Tour tour;
  for (size_t i = 0; i < steps->size(); ++i) try {
      tour.steps.push_back(step((*steps)[i]));
    } catch (const Wrong& wrong) {
      const std::string field = "steps[" + std::to_string(i) + "]";
      return invalid(field, "", "the tour's " + field + ": " + wrong.message);
    }
  return tour;
}

Tour usualTour(const v1::World& world, const std::vector<v1::Prefab>& prefabs) {
  const auto camera = [&](int i) { return world.cameras(i % world.cameras_size()).name(); };
  Tour tour;
  tour.steps = {{Fly{camera(0), camera(1)}, 8}, {Jump{camera(2)}, 3}, {Jump{camera(3)}, 3}};
  const auto preferred = [](const v1::Prefab& p) { return p.buildable() && p.category() == "house"; };
  auto prefab = std::find_if(prefabs.begin(), prefabs.end(), preferred);
  if (prefab == prefabs.end())
    prefab = std::find_if(prefabs.begin(), prefabs.end(), [](const v1::Prefab& p) { return p.buildable(); });
  if (prefab != prefabs.end()) {
    tour.steps.push_back({BuildStep{"category:" + prefab->category(), 40, {60.0f, {}}}, 4});
    tour.steps.push_back({DestroyStep{{60.0f, {}}, 60}, 4});
  }
  return tour;
}

}  // namespace helio::cli
