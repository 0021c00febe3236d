#include "bench/settings.h"

#include <spdlog/fmt/fmt.h>
#include <cmath>
#include <functional>
#include <map>

#include "render/light_switches.h"

namespace helio::bench {
namespace {

using Setter = std::function<void(render::ViewSettings&, double)>;

template <typename T>
Setter into(T render::ViewSettings::*field) {
  return [field](render::ViewSettings& settings, double value) { settings.*field = static_cast<T>(value); };
}

const std::map<std::string, Setter>& setters() {
  using S = render::ViewSettings;
  static const auto table = [] {
    std::map<std::string, Setter> setters{{"bounces", into(&S::bounces)},
                                          {"lamp_samples", into(&S::lamp_samples)},
                                          {"regularisation", into(&S::regularisation)},
                                          {"path_launches", into(&S::path_launches)},
                                          {"sun_shadow", into(&S::sun_shadow)},
                                          {"culling_view", into(&S::culling_view)},
                                          {"denoiser", into(&S::denoiser)},
                                          {"taa", into(&S::taa)},
                                          {"extra_samples", into(&S::extra_samples)},
                                          {"technique", into(&S::technique)},
                                          {"ambient", into(&S::ambient)},
                                          {"ambient_radius", into(&S::ambient_radius)},
                                          {"indirect_rate", into(&S::indirect_rate)},
                                          {"reconstruction", into(&S::reconstruction)},
                                          {"aperture", into(&S::aperture)},
                                          {"focus", into(&S::focus)},
                                          {"shadow_map_size", into(&S::shadow_map_size)},
                                          {"rasteriser", into(&S::rasteriser)},
                                          {"levels_of_detail", into(&S::levels_of_detail)}};
    for (const render::LightSwitch& each : render::kLightSwitches) setters[each.name] = into(each.field);
    return setters;
  }();
  return table;
}

}  // namespace

void addSettingOptions(CLI::App& command, std::vector<std::string>& assignments) {
  command.add_option("--set", assignments, "a setting of the view, NAME=VALUE; yes and no are 1 and 0");
}

Result<void> apply(const std::vector<std::string>& assignments, render::ViewSettings& settings) {
  for (const std::string& assignment : assignments) {
    const size_t equals = assignment.find('=');
    const std::string name = assignment.substr(0, equals);
    const auto setter = setters().find(name);
    if (equals == std::string::npos || setter == setters().end()) {
      std::string known;
      for (const auto& [candidate, _] : setters()) known.append(known.empty() ? "" : ", ").append(candidate);
      return invalid("set", assignment, fmt::format("--set {}: give NAME=VALUE with a name of {}", assignment, known));
    }
    double value = 0.0;
    if (!CLI::detail::lexical_cast(assignment.substr(equals + 1), value) || !std::isfinite(value) || value < 0.0)
      return invalid("set", assignment, "--set " + assignment + ": the value must be a number, 0 or more");
    setter->second(settings, value);
  }
  return {};
}

}  // namespace helio::bench
