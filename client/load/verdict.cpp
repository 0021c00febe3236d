#include "load/verdict.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/median.h"

namespace helio::load {
namespace {

std::optional<double> valueOf(const Scenario& scenario, const RunResult& run, const Objective& objective) {
  if (objective.statistic.empty()) return numberOf(scenario, run, objective.metric, objective.group);
  return statistic(valuesOf(scenario, run, objective.metric, objective.group), objective.statistic);
}

/// Of each run of a variant; empty when a run has none.
std::vector<double> valuesOf(const Scenario& scenario, const std::vector<RunResult>& runs, const Objective& objective,
                             const std::string& variant) {
  std::vector<double> out;
  for (const auto& run : runs) {
    if (!variant.empty() && run.variant != variant) continue;
    const auto value = valueOf(scenario, run, objective);
    if (!value) return {};
    out.push_back(*value);
  }
  return out;
}

/// By nearest rank: of three values or fewer it is the whole range, of more it forgives the odd run out.
double interquartileRange(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return *statistic(values, "p75") - *statistic(values, "p25");
}

std::string text(const char* format, double a, double b) {
  char out[120];
  std::snprintf(out, sizeof out, format, a, b);
  return out;
}

}  // namespace

std::vector<Judged> judge(const Scenario& scenario, const std::vector<RunResult>& runs) {
  std::vector<Judged> out;
  for (const Objective& objective : scenario.objectives) {
    Judged judged{objective.name, std::nullopt, objective.limit, objective.at_most, false, {}};
    const auto values = valuesOf(scenario, runs, objective, objective.variant);
    if (values.empty()) {
      judged.note = "nothing was measured";
    } else if (objective.against.empty()) {
      const auto [least, most] = std::minmax_element(values.begin(), values.end());
      judged.value = objective.at_most ? *most : *least;
      if (values.size() > 1) judged.note = "the worst of " + std::to_string(values.size()) + " runs";
    } else if (const auto others = valuesOf(scenario, runs, objective, objective.against); !others.empty()) {
      const double usual = median(others), here = median(values);
      const double scale = objective.difference ? 1 : 100 / usual;
      const double spread = interquartileRange(others) * scale;
      judged.value = (here - usual) * scale;
      judged.limit += objective.at_most ? spread : -spread;
      judged.note = text("median %.3f against %.3f", here, usual) +
                    text(", the limit is %.3g and the interquartile range of runs, %.3g", objective.limit, spread);
      if (!std::isfinite(*judged.value)) judged.value.reset();
    }
    if (judged.value) judged.met = judged.at_most ? *judged.value <= judged.limit : *judged.value >= judged.limit;
    out.push_back(std::move(judged));
  }
  return out;
}

Result<std::vector<Change>> compare(const Json& baseline, const Json& report) {
  const auto wrong = [](const std::string& message) { return invalid("baseline", "", "--baseline: " + message); };
  if (!baseline.is_object() || baseline.value("schema", "") != report.at("schema").get<std::string>())
    return wrong("the file is no JSON report of helio-load");
  const std::string scenario = report.at("scenario").get<std::string>();
  if (baseline.value("scenario", "") != scenario)
    return wrong("the file is of scenario \"" + baseline.value("scenario", "") + "\", this is \"" + scenario + "\"");
  std::vector<Change> out;
  try {
    const auto& before = baseline.at("runs").at(0).at("groups");
    for (const auto& [group, figures] : report.at("runs").at(0).at("groups").items()) {
      if (!before.contains(group)) continue;
      const auto& old = before.at(group).at("series");
      for (const auto& [series, summary] : figures.at("series").items())
        for (const char* statistic : {"p50", "p99"})
          if (old.contains(series))
            out.push_back({group, series, statistic, old.at(series).at(statistic), summary.at(statistic)});
    }
  } catch (const Json::exception& error) { return wrong(std::string("the file is damaged: ") + error.what()); }
  return out;
}

}  // namespace helio::load
