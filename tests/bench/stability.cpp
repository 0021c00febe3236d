#include "bench/stability.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>

#include "bench/device.h"
#include "bench/files.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/stability_page.h"
#include "hard/trial.h"
#include "stream/picture.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes =
    R"(Renders each hard case (tests/hard) at 1, 10, 100 and 1000 times the hard parameter, in reference mode and in hybrid mode
with traced and rasterised primary hits, with as many samples as a mean within 1 % takes. Prints for each the samples and texels that
were not finite, the energy gained, the error against truth and the worst pixel; writes stability.html with plots and pictures,
and stability.json. Exit status 1 when a property does not hold.

Examples:
  helio-bench stability
  helio-bench stability --case pinhole_room --case white_sphere --out out/rooms --json)";

struct StabilityOptions {
  std::vector<std::string> cases;
  std::string out = "out/stability";
  render::RendererOptions renderer;
  bool json = false;
};

Result<std::vector<const test::HardCase*>> chosenCases(const std::vector<std::string>& names) {
  std::vector<const test::HardCase*> list;
  std::string known;
  for (const test::HardCase& c : test::hardCases()) {
    if (names.empty() || std::find(names.begin(), names.end(), c.name) != names.end()) list.push_back(&c);
    known += (known.empty() ? "" : ", ") + c.name;
  }
  for (const std::string& name : names)
    if (std::none_of(list.begin(), list.end(), [&](const auto* c) { return c->name == name; }))
      return invalid("--case", name, "there is no case \"" + name + "\": give one of " + known);
  return list;
}

Result<StabilityResult> tryWay(render::Renderer& renderer, const test::HardScene& scene, const test::Way& way) {
  auto measured = test::measure(renderer, scene, way, true);
  if (!measured) return measured.error();
  auto png = stream::encodePng(*measured->frame.pixels);
  if (!png) return png.error();
  return StabilityResult{way.name,
                         measured->samples,
                         measured->nonfinite,
                         measured->broken_texels,
                         measured->mean,
                         measured->standard_error,
                         measured->energy_error,
                         measured->worst_texel,
                         measured->error,
                         measured->similarity,
                         test::broken(scene, *measured, true),
                         std::move(*png)};
}

Result<StabilityCase> tryCase(render::Renderer& renderer, const test::HardCase& hard) {
  StabilityCase result{hard.name, hard.parameter, hard.variants, {}};
  Progress progress(hard.name, hard.values.size() * test::kWays.size());
  for (const double value : hard.values) {
    const test::HardScene scene = hard.make(value);
    StabilityPoint& point = result.points.emplace_back(StabilityPoint{value, scene.truth, {}});
    for (const test::Way& way : test::kWays) {
      auto tried = tryWay(renderer, scene, way);
      if (!tried) return tried.error();
      point.results.push_back(std::move(*tried));
      progress.step();
    }
  }
  return result;
}

Json optional(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

Json toJson(const StabilityCase& c) {
  Json json{{"name", c.name}, {"parameter", c.parameter}, {"variants", c.variants}, {"holds", c.holds()}};
  for (const StabilityPoint& point : c.points) {
    Json& row = json["points"].emplace_back(Json{{"value", point.value}, {"truth", optional(point.truth)}});
    for (const StabilityResult& r : point.results)
      row["results"].push_back({{"way", r.way},
                                {"samples", r.samples},
                                {"nonfinite", {{"samples", r.nonfinite_samples}, {"texels", r.broken_texels}}},
                                {"mean", r.mean},
                                {"standard_error", r.standard_error},
                                {"error", optional(r.error)},
                                {"energy_error", r.energy_error},
                                {"similarity", optional(r.similarity)},
                                {"worst_pixel", r.worst_texel},
                                {"broken", r.broken}});
  }
  return json;
}

void addRows(Table& table, const StabilityCase& c) {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", value);
    return std::string(text);
  };
  for (const StabilityPoint& point : c.points)
    for (const StabilityResult& r : point.results)
      table.add({c.name, number(point.value), r.way, grouped(r.nonfinite_samples), grouped(r.broken_texels),
                 r.error        ? number(*r.error)
                 : r.similarity ? "SSIM " + fixed(*r.similarity, 4)
                                : "",
                 number(r.energy_error), number(r.worst_texel), r.holds() ? "yes" : "NO"});
}

Result<void> measureAll(const StabilityOptions& options, const std::string& command_line) {
  const auto chosen = chosenCases(options.cases);
  if (!chosen) return chosen.error();
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return invalid("--out", options.out, "cannot make the folder " + options.out + ": " + error.message());
  auto renderer = render::makeRenderer(options.renderer);
  if (!renderer) return renderer.error();
  const Provenance origin = provenance((*renderer)->device(), command_line);

  std::vector<StabilityCase> cases;
  Json document{{"schema", "heliograph.bench.stability/1"}};
  append(document, origin);
  document["cases"] = Json::array();
  Table table({"case", "value", "way", "samples not finite", "texels", "error", "energy", "worst pixel", "holds"});
  for (const test::HardCase* hard : *chosen) {
    auto tried = tryCase(**renderer, *hard);
    if (!tried) return tried.error();
    document["cases"].push_back(toJson(*tried));
    addRows(table, *tried);
    cases.push_back(std::move(*tried));
  }
  if (auto written = writeFile(options.out + "/stability.html", stabilityPage(origin, cases)); !written) return written;
  if (auto written = writeFile(options.out + "/stability.json", document.dump(1) + "\n"); !written) return written;
  std::cout << (options.json ? document.dump(2) + "\n" : markdown(origin) + "\n" + table.markdown()) << std::flush;
  if (!std::cout) return Error{ErrorKind::internal, "cannot write the result to standard output", {}, {}, {}};

  std::string failed;
  for (const StabilityCase& c : cases)
    if (!c.holds()) failed += (failed.empty() ? "" : ", ") + c.name;
  if (!failed.empty())
    return Error{
        ErrorKind::internal, "does not hold: " + failed + "; " + options.out + "/stability.html shows how", {}, {}, {}};
  return {};
}

}  // namespace

void addStabilityCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<StabilityOptions>();
  CLI::App& command = *app.add_subcommand("stability", "numerically hard cases at growing difficulty");
  command.footer(kNotes);
  command.add_option("--case", options->cases, "only this one; may be given several times");
  command.add_option("--out", options->out, "a folder for the page")->capture_default_str();
  addDeviceOptions(command, options->renderer);
  command.add_flag("--json", options->json, "print one JSON document");
  command.callback([options, command_line, &chosen] {
    chosen = [options, command_line] { return measureAll(*options, command_line); };
  });
}

}  // namespace helio::bench
