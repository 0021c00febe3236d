#include "bench/sampler.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>

#include "bench/accumulation.h"
#include "bench/device.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/settings.h"
#include "bench/stage.h"
#include "scene/spec.h"

namespace helio::bench {
namespace {

using render::Sampler;

constexpr const char* kNotes =
    R"(Renders a scene in reference mode with either sampler and prints the relative mean square error at 1, 2, 4, ... samples
a pixel. The truth is the mean of all samples of both runs beyond the first 1024, which no measured picture contains.
The slope is that of log error against log samples: -1 for independent samples, steeper where the sampler helps.
The mean is over all pixels, so a few rare bright paths, which no sampler can place, may make most of it; beside it stand
the ratio of the median pixels' errors and the share of the low-discrepancy sampler's error in the worst 0.1 % of pixels.

Examples:
  helio-bench sampler --spec cornell.json
  helio-bench sampler --camera tilted_city --instances 1000 --size 160x90 --truth 4096)";

constexpr double kWorst = 0.001;   // of the pixels
constexpr uint32_t kBlock = 1024;  // samples of the low-discrepancy sequence that belong together

struct SamplerOptions {
  StageOptions stage;
  std::string spec;
  std::vector<std::string> settings;
  render::RendererOptions renderer;
  uint32_t width = 160, height = 90, bounces = 3;
  uint32_t most = 256, truth = 2048;
  bool json = false;
};

struct Subject {
  std::string name;
  scene::ScenePtr scene;
  scene::NamedCamera camera;
  render::ViewSettings settings;
};

Result<Subject> open(const SamplerOptions& options) {
  if (!options.spec.empty()) {
    const auto spec = scene::loadSpec(options.spec);
    if (!spec) return spec.error();
    return Subject{spec->name, spec->scene, spec->scene->cameras.front(), specSettings(*spec)};
  }
  if (auto valid = check(options.stage); !valid) return valid.error();
  const auto stage = Stage::open(options.stage);
  if (!stage) return stage.error();
  return Subject{stage->camera().name, stage->scene(), stage->camera(),
                 referenceSettings(options.width, options.height, options.bounces)};
}

/// Pictures by sample count, and what came after the first block.
struct Run {
  std::map<uint32_t, Image> pictures;
  Image truth;
};

Result<Run> render(render::Renderer& renderer, const Subject& subject, Sampler sampler, const SamplerOptions& options) {
  render::ViewSettings settings = subject.settings;
  settings.sampler = sampler;
  if (auto applied = apply(options.settings, settings); !applied) return applied.error();
  auto accumulation = Accumulation::start(renderer, subject.scene, subject.camera, settings);
  if (!accumulation) return accumulation.error();
  Progress progress(sampler == Sampler::independent ? "independent" : "low discrepancy", kBlock + options.truth);
  const auto step = [&] { progress.step(); };
  Run run;
  for (uint32_t samples = 1; samples <= options.most; samples *= 2) {
    if (auto grown = (*accumulation)->growTo(samples, step); !grown) return grown.error();
    run.pictures[samples] = (*accumulation)->image();
  }
  if (auto grown = (*accumulation)->growTo(kBlock, step); !grown) return grown.error();
  const Image block = (*accumulation)->image();
  if (auto grown = (*accumulation)->growTo(kBlock + options.truth, step); !grown) return grown.error();
  run.truth = rest((*accumulation)->image(), kBlock + options.truth, block, kBlock);
  return run;
}

/// Least squares through (log samples, log error).
double slope(const std::map<uint32_t, double>& errors) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [samples, error] : errors) {
    const double a = std::log(samples), b = std::log(error);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

Result<void> measure(const SamplerOptions& options, const std::string& command_line) {
  const auto subject = open(options);
  if (!subject) return subject.error();
  auto renderer = render::makeRenderer(options.renderer);
  if (!renderer) return renderer.error();
  const Provenance origin = provenance((*renderer)->device(), command_line);

  std::array<Run, 2> runs;
  for (const Sampler sampler : {Sampler::low_discrepancy, Sampler::independent}) {
    auto run = render(**renderer, *subject, sampler, options);
    if (!run) return run.error();
    runs[static_cast<size_t>(sampler)] = std::move(*run);
  }
  Image truth = runs[0].truth;
  for (size_t i = 0; i < truth.rgb.size(); ++i) truth.rgb[i] = 0.5f * (truth.rgb[i] + runs[1].truth.rgb[i]);

  std::array<std::map<uint32_t, double>, 2> errors;
  Json document{{"schema", "heliograph.bench.sampler/1"}};
  append(document, origin);
  document["scene"] = subject->name;
  document["samples"] = Json::array();
  Table table({"samples", "low discrepancy", "independent", "ratio", "of medians", "in the worst 0.1 %"});
  for (uint32_t samples = 1; samples <= options.most; samples *= 2) {
    for (size_t i = 0; i < 2; ++i) errors[i][samples] = relativeMse(runs[i].pictures.at(samples), truth);
    const double ratio = errors[0][samples] / errors[1][samples];
    const double medians = medianRelativeSquare(runs[0].pictures.at(samples), truth) /
                           medianRelativeSquare(runs[1].pictures.at(samples), truth);
    const double worst = shareOfWorst(runs[0].pictures.at(samples), truth, kWorst);
    document["samples"].push_back({{"samples", samples},
                                   {"low_discrepancy", errors[0][samples]},
                                   {"independent", errors[1][samples]},
                                   {"ratio", ratio},
                                   {"ratio_of_medians", medians},
                                   {"share_of_worst", worst}});
    table.add({grouped(samples), fixed(errors[0][samples], 6), fixed(errors[1][samples], 6), fixed(ratio, 3),
               fixed(medians, 3), fixed(100.0 * worst, 1) + " %"});
  }
  document["slope"] = {{"low_discrepancy", slope(errors[0])}, {"independent", slope(errors[1])}};
  table.add({"slope", fixed(slope(errors[0]), 2), fixed(slope(errors[1]), 2), "", "", ""});
  std::cout << (options.json ? document.dump(2) + "\n"
                             : markdown(origin) + "- scene: " + subject->name + "\n\n" + table.markdown())
            << std::flush;
  if (!std::cout) return Error{ErrorKind::internal, "cannot write the result to standard output", {}, {}, {}};
  return {};
}

}  // namespace

void addSamplerCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<SamplerOptions>();
  CLI::App& command = *app.add_subcommand("sampler", "error against samples, of either sampler");
  command.footer(kNotes);
  addStageOptions(command, options->stage);
  command.add_option("--spec", options->spec, "instead of --scene: a SPEC.json")->check(CLI::ExistingFile);
  addSizeOption(command, options->width, options->height);
  command.add_option("--bounces", options->bounces, "of a path, 0 to 32")->capture_default_str();
  command.add_option("--most", options->most, "measured samples, 1 to 1024")
      ->capture_default_str()
      ->check(CLI::Range(1u, kBlock));
  command.add_option("--truth", options->truth, "further samples that the truth is made of")
      ->capture_default_str()
      ->check(CLI::Range(64u, 1'000'000u));
  addSettingOptions(command, options->settings);
  addDeviceOptions(command, options->renderer);
  command.add_flag("--json", options->json, "print one JSON document");
  command.callback([options, command_line, &chosen] {
    chosen = [options, command_line] { return measure(*options, command_line); };
  });
}

}  // namespace helio::bench
