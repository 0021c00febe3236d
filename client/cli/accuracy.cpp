// helio accuracy: how far a live picture is from the truth.
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "cli/command.h"
#include "cli/progress.h"

namespace helio::cli {
namespace {

struct AccuracyOptions : Viewpoint {
  std::string world, out, size = "640x360", primary = "raster", materials = "none";
  uint64_t viewer = 0;
  uint32_t frames = 8, bounces = 3, samples = 1, reference_samples = 256, reference_bounces = 0;
  v1::LightTransport light;
  Approximations approximations;
};

v1::Settings settingsOf(const AccuracyOptions& options) {
  const Size size = parseSize(options.size);
  v1::Settings settings;
  settings.set_width(size.width);
  settings.set_height(size.height);
  settings.set_primary(parsePrimary(options.primary));
  settings.set_bounces(options.bounces);
  settings.set_samples(options.samples);
  settings.set_materials(parseMaterials(options.materials));
  *settings.mutable_light_transport() = options.light;
  options.approximations.put(settings);
  return settings;
}

v1::MeasureAccuracyRequest requestOf(const AccuracyOptions& options) {
  v1::MeasureAccuracyRequest request;
  request.set_world(options.world);
  request.set_samples(options.reference_samples);
  if (options.reference_bounces > 0) request.set_bounces(options.reference_bounces);
  request.set_pictures(!options.out.empty());
  if (options.viewer != 0) {
    request.set_viewer(options.viewer);
    return request;
  }
  *request.mutable_settings() = settingsOf(options);
  request.set_frames(options.frames);
  options.put(request);
  return request;
}

Json describe(const AccuracyOptions& options, const v1::AccuracyResult& result) {
  Json files = Json::array();
  for (const auto& picture : result.pictures()) files.push_back(picture.name() + ".png");
  return {{"schema", "heliograph.accuracy/1"},
          {"world", options.world},
          {"viewer", options.viewer != 0 ? Json(options.viewer) : Json()},
          {"tick", result.tick()},
          {"applied_seq", result.applied_seq()},
          {"world_time", result.time()},
          {"width", result.settings().width()},
          {"height", result.settings().height()},
          {"bounces", result.settings().bounces()},
          {"samples", result.settings().samples()},
          {"accumulated", result.accumulated()},
          {"exposure", result.exposure()},
          {"relative_mse", result.relative_mse()},
          {"ssim", result.ssim()},
          {"flip", result.flip()},
          {"estimate", result.has_estimate()
                           ? Json{{"variance", result.estimate().variance()}, {"bias", result.estimate().bias()}}
                           : Json()},
          {"reference",
           {{"samples", result.samples()},
            {"bounces", result.bounces()},
            {"noise", result.reference_noise()},
            {"gpu_ms", result.gpu_ms()}}},
          {"out", options.out.empty() ? Json() : Json(options.out)},
          {"files", std::move(files)}};
}

void measure(const Common& common, const AccuracyOptions& options) {
  if (options.position.empty() != options.target.empty()) throw Stop{"--position and --target go together"};
  if (!options.position.empty() && options.position == options.target)
    throw Stop{"--position and --target are the same point; there is no direction to look in"};
  const std::filesystem::path folder = options.out;
  std::error_code error;
  if (!options.out.empty()) std::filesystem::create_directories(folder, error);
  if (error) throw Stop{"cannot make the folder " + options.out + ": " + error.message()};
  client::Connection connection(common.server);
  ProgressBar bar("reference");
  const auto accuracy = get(connection.measureAccuracy(requestOf(options), [&](const v1::AccuracyProgress& progress) {
    char note[96];
    std::snprintf(note, sizeof note, "%u/%u samples, relative MSE so far %.3g", progress.samples(), progress.wanted(),
                  progress.relative_mse());
    bar.show(double(progress.samples()) / progress.wanted(), progress.samples() > 0 ? note : "waiting for the picture");
  }));
  const auto& result = accuracy.result;
  const Json document = describe(options, result);
  if (!options.out.empty()) {
    for (size_t i = 0; i < accuracy.pictures.size(); ++i)
      writeFile((folder / (result.pictures(static_cast<int>(i)).name() + ".png")).string(), accuracy.pictures[i]);
    writeFile((folder / "accuracy.json").string(), document.dump(1) + "\n");
  }
  if (common.json) return print(document);
  std::printf(
      "relative MSE %.4g (the reference of %u samples and %u bounces has %.2g of noise), SSIM %.4f, FLIP %.4f\n",
      result.relative_mse(), result.samples(), result.bounces(), result.reference_noise(), result.ssim(),
      result.flip());
  if (result.has_estimate())
    std::printf("the server believed %.4g: %.4g noise, %.4g bias\n",
                double(result.estimate().variance() + result.estimate().bias()), double(result.estimate().variance()),
                double(result.estimate().bias()));
  if (!options.out.empty()) std::printf("%s: live.png, reference.png, error.png, accuracy.json\n", options.out.c_str());
}

}  // namespace

void addAccuracy(CLI::App& app, Common& common) {
  auto options = std::make_shared<AccuracyOptions>();
  auto* command = app.add_subcommand(
      "accuracy", "The true error of a live picture, against a reference that converges beside the streams.");
  addCommon(*command, common);
  command->footer(R"(Examples:
  helio accuracy --world city --viewer 3 --out accuracy
  helio accuracy --world city --camera forest --size 320x180 --denoiser svgf --frames 16 --samples 512 --json
The world is frozen in a copy as the picture shows it; edits and viewers go on meanwhile. helio top shows viewers' numbers.)");
  command->add_option("--world,world", options->world, "a world of the server")->required();
  auto* viewer = command->add_option("--viewer", options->viewer, "whose next picture is judged, with its settings")
                     ->check(CLI::PositiveNumber);
  auto* camera = command->add_option("--camera", options->camera, "a picture of the server's own: a named camera");
  auto* position = command->add_option("--position", options->position, "likewise: x y z in metres")->expected(3);
  command->add_option("--target", options->target, "x y z in metres")->expected(3);
  command->add_option("--vfov", options->vfov, "vertical angle in degrees, with --position")->capture_default_str();
  command->add_option("--size", options->size, "of a picture of the server's own: WIDTHxHEIGHT in pixels")
      ->capture_default_str();
  command->add_option("--primary", options->primary, "likewise: raster or traced")
      ->capture_default_str()
      ->check(CLI::IsMember({"raster", "traced"}));
  command->add_option("--bounces", options->bounces, "likewise: 0 to 32")
      ->capture_default_str()
      ->check(CLI::Range(0u, 32u));
  command->add_option("--spp", options->samples, "likewise: paths a pixel a frame, 1 to 64")
      ->capture_default_str()
      ->check(CLI::Range(1u, 64u));
  command->add_option("--frames", options->frames, "likewise: of a view without a history, the last is judged")
      ->capture_default_str()
      ->check(CLI::Range(1u, 1024u));
  addMaterials(*command, options->materials);
  addLightTransport(*command, options->light);
  addApproximations(*command, options->approximations);
  command->add_option("--samples", options->reference_samples, "of the reference, a pixel")
      ->capture_default_str()
      ->check(CLI::Range(2u, 65'536u));
  command->add_option("--reference-bounces", options->reference_bounces, "default: 8, or the picture's if more")
      ->check(CLI::Range(1u, 32u));
  command->add_option("--out", options->out, "a folder for live.png, reference.png, error.png and accuracy.json");
  viewer->excludes(camera)->excludes(position);
  camera->excludes(position);
  command->callback([&common, options] { measure(common, *options); });
}

}  // namespace helio::cli
