#include "bench/fidelity.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "bench/accumulation.h"
#include "bench/device.h"
#include "bench/files.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/settings.h"
#include "scene/spec.h"
#include "stream/picture.h"

namespace helio::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNotes =
    R"(Renders what the SPEC asks for in reference mode: traced primary rays all over the pixel, no Russian roulette, every
sample kept. Writes NAME.pfm (linear radiance) and NAME.png. Where NAME.ref.pfm stands beside the SPEC, the picture is
compared with it, and NAME.difference.png shows where it is brighter (red) or darker (blue); full colour is 10 %.

Examples:
  helio-bench fidelity cornell.json --spp 256
  helio-bench fidelity scenes/*.json --out out/fidelity --json)";

constexpr double kFullColour = 0.1;

struct FidelityOptions {
  std::vector<std::string> specs;
  uint32_t samples = 0;  // 0: the spec's
  std::string out = "out/fidelity";
  std::vector<std::string> settings;
  render::RendererOptions renderer;
  bool json = false;
};

/// Against the other renderer's picture.
struct Comparison {
  glm::dvec3 reference_mean, ratio;
  double relative_mse = 0.0;
};

struct Picture {
  std::string name;
  uint32_t width = 0, height = 0, samples = 0, bounces = 0;
  uint64_t rays = 0, nonfinite = 0;
  double gpu_ms = 0.0, noise = 0.0;
  Image image;
  std::string png;
  std::optional<Comparison> comparison;

  double secondsPerMsample() const { return 1e-3 * gpu_ms / (1e-6 * width * height * samples); }
};

Result<Picture> renderSpec(render::Renderer& renderer, const scene::Spec& spec, const FidelityOptions& options) {
  const uint32_t samples = options.samples ? options.samples : spec.samples;
  render::ViewSettings settings = specSettings(spec);
  if (auto applied = apply(options.settings, settings); !applied) return applied.error();
  auto accumulation = Accumulation::start(renderer, spec.scene, spec.scene->cameras.front(), settings);
  if (!accumulation) return accumulation.error();
  Accumulation& run = **accumulation;
  Progress progress(spec.name, samples);
  const auto step = [&] { progress.step(); };

  // In the middle a copy is kept: two halves tell the noise.
  const uint32_t half = samples / 2;
  if (auto grown = run.growTo(half, step); !grown) return grown.error();
  const Image first_half = half > 0 ? run.image() : Image();
  if (auto grown = run.growTo(samples, step); !grown) return grown.error();

  Picture picture{spec.name, spec.width, spec.height, samples, spec.bounces};
  picture.rays = run.rays();
  picture.nonfinite = run.nonfinite();
  picture.gpu_ms = run.gpuMs();
  picture.image = run.image();
  if (half > 0) picture.noise = noiseFloor(first_half, rest(picture.image, samples, first_half, half));
  const auto png = stream::encodePng(run.pixels());
  if (!png) return png.error();
  picture.png = *png;
  return picture;
}

Result<void> compare(Picture& picture, const fs::path& spec) {
  const fs::path reference_file = spec.parent_path() / (picture.name + ".ref.pfm");
  if (!fs::exists(reference_file)) return {};
  const auto reference = readPfm(reference_file.string());
  if (!reference) return reference.error();
  if (reference->width != picture.width || reference->height != picture.height)
    return invalid("spec", spec.string(),
                   reference_file.string() + " has another size than " + spec.string() + " asks for");
  Comparison comparison;
  comparison.reference_mean = mean(*reference);
  comparison.ratio = mean(picture.image) / comparison.reference_mean;
  comparison.relative_mse = relativeMse(picture.image, *reference);
  picture.comparison = comparison;
  return {};
}

Result<void> writePictures(const Picture& picture, const fs::path& spec, const fs::path& folder) {
  const std::string stem = (folder / picture.name).string();
  if (auto written = writeFile(stem + ".png", picture.png); !written) return written;
  if (auto written = writeFile(stem + ".pfm", stream::encodePfm(picture.image.rgb, picture.width, picture.height));
      !written)
    return written;
  if (!picture.comparison) return {};
  const auto reference = readPfm((spec.parent_path() / (picture.name + ".ref.pfm")).string());
  if (!reference) return reference.error();
  const std::vector<uint8_t> rgba = differencePicture(picture.image, *reference, kFullColour);
  const auto difference = stream::encodePng({rgba.data(), picture.width, picture.height});
  if (!difference) return difference.error();
  return writeFile(stem + ".difference.png", *difference);
}

Json vector(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json toJson(const Picture& picture) {
  Json json{{"name", picture.name},
            {"width", picture.width},
            {"height", picture.height},
            {"samples", picture.samples},
            {"bounces", picture.bounces},
            {"mean", vector(mean(picture.image))},
            {"noise_floor", picture.noise},
            {"gpu_ms", picture.gpu_ms},
            {"seconds_per_msample", picture.secondsPerMsample()},
            {"rays", picture.rays},
            {"nonfinite", picture.nonfinite}};
  if (picture.comparison)
    json["reference"] = {{"mean", vector(picture.comparison->reference_mean)},
                         {"ratio", vector(picture.comparison->ratio)},
                         {"relative_mse", picture.comparison->relative_mse}};
  return json;
}

std::string triple(const glm::dvec3& v) { return fixed(v.x, 5) + " " + fixed(v.y, 5) + " " + fixed(v.z, 5); }

Result<void> measure(const FidelityOptions& options, const std::string& command_line) {
  // Read everything before the first picture.
  std::vector<scene::Spec> specs;
  for (const std::string& file : options.specs) {
    auto spec = scene::loadSpec(file);
    if (!spec) return spec.error();
    specs.push_back(std::move(*spec));
  }
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) return invalid("--out", options.out, "cannot make the folder " + options.out + ": " + error.message());
  auto renderer = render::makeRenderer(options.renderer);
  if (!renderer) return renderer.error();
  const Provenance origin = provenance((*renderer)->device(), command_line);

  Json document{{"schema", "heliograph.bench.fidelity/1"}};
  append(document, origin);
  document["pictures"] = Json::array();
  Table table(
      {"picture", "samples", "mean RGB", "ratio of means", "relative MSE", "noise floor", "not finite", "s/Msample"});
  for (size_t i = 0; i < specs.size(); ++i) {
    auto picture = renderSpec(**renderer, specs[i], options);
    if (!picture) return picture.error();
    if (auto compared = compare(*picture, options.specs[i]); !compared) return compared;
    if (auto written = writePictures(*picture, options.specs[i], options.out); !written) return written;
    document["pictures"].push_back(toJson(*picture));
    const auto& comparison = picture->comparison;
    table.add({picture->name, grouped(picture->samples), triple(mean(picture->image)),
               comparison ? triple(comparison->ratio) : "", comparison ? fixed(comparison->relative_mse, 6) : "",
               fixed(picture->noise, 6), grouped(picture->nonfinite), fixed(picture->secondsPerMsample(), 3)});
  }
  std::cout << (options.json ? document.dump(2) + "\n" : markdown(origin) + "\n" + table.markdown()) << std::flush;
  if (!std::cout) return Error{ErrorKind::internal, "cannot write the result to standard output", {}, {}, {}};
  return {};
}

}  // namespace

void addFidelityCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<FidelityOptions>();
  CLI::App& command = *app.add_subcommand("fidelity", "pictures in reference mode, beside another renderer's");
  command.footer(kNotes);
  command.add_option("spec", options->specs, "what to render: SPEC.json ...")->required()->check(CLI::ExistingFile);
  command.add_option("--spp", options->samples, "samples a pixel; default: the SPEC's")
      ->check(CLI::Range(1, 1'000'000));
  command.add_option("--out", options->out, "a folder for the pictures")->capture_default_str();
  addSettingOptions(command, options->settings);
  addDeviceOptions(command, options->renderer);
  command.add_flag("--json", options->json, "print one JSON document");
  command.callback([options, command_line, &chosen] {
    chosen = [options, command_line] { return measure(*options, command_line); };
  });
}

}  // namespace helio::bench
