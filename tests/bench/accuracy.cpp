#include "bench/accuracy.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <numeric>

#include "bench/accumulation.h"
#include "bench/accuracy_path.h"
#include "bench/device.h"
#include "bench/files.h"
#include "bench/progress.h"
#include "bench/settings.h"
#include "render/metrics/flip.h"
#include "stream/picture.h"

namespace helio::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNotes =
    R"(Renders a converged reference, then each setting of each axis with everything else at its base: one path a pixel, three
bounces, no denoiser. A run is --frames ticks from a view without a history, or behind a jump; its last frame is judged.
Errors are relative MSE in linear radiance, apart into bias (what all runs share) and variance (what they do not), and SSIM
and FLIP of the displayed picture. Writes accuracy.html, .csv and .json below --out.

Examples:
  helio-bench accuracy --size 160x90 --axis spp --axis denoiser
  helio-bench accuracy --scene cornell.gltf --size 1920x1080 --runs 16 --motion fly --json)";

constexpr uint32_t kSettlingTicks = 60, kTimedTicks = 16;
constexpr uint32_t kTicksUntilCulled = 64;  // light path guided culling: guesses are gone, and hits averaged
constexpr uint32_t kSamplesForExposure = 16;

/// What all settings are measured against.
struct Reference {
  Image image;
  std::vector<uint8_t> pixels;  // displayed
  std::optional<SeenPicture> seen;
  double noise = 0.0;
  float exposure_ev = 0.0f;
};

std::vector<uint8_t> displayed(const render::Pixels& pixels) {
  return {pixels.rgbx, pixels.rgbx + size_t{4} * pixels.width * pixels.height};
}

/// `exposure_ev`: nothing: what brings the mean to middle grey.
Result<Reference> renderReference(render::Renderer& renderer, const scene::ScenePtr& scene,
                                  const scene::NamedCamera& camera, const std::optional<float>& exposure_ev,
                                  const AccuracyOptions& options) {
  render::ViewSettings settings = referenceSettings(options.width, options.height, options.reference_bounces);
  settings.roulette = true;  // unbiased, and bounces are many
  Reference reference;
  if (exposure_ev) {
    reference.exposure_ev = *exposure_ev;
  } else {
    auto first = Accumulation::start(renderer, scene, camera, settings);
    if (!first) return first.error();
    if (auto grown = (*first)->growTo(kSamplesForExposure); !grown) return grown.error();
    const double luminance = glm::dot(mean((*first)->image()), glm::dvec3(0.2126, 0.7152, 0.0722));
    if (luminance > 0.0)
      reference.exposure_ev = static_cast<float>(std::clamp(std::log2(0.18 / luminance), -16.0, 16.0));
  }
  settings.exposure_ev = reference.exposure_ev;
  auto accumulation = Accumulation::start(renderer, scene, camera, settings);
  if (!accumulation) return accumulation.error();
  Progress progress("reference", options.reference_samples);
  const auto step = [&] { progress.step(); };
  const uint32_t half = options.reference_samples / 2;
  if (auto grown = (*accumulation)->growTo(half, step); !grown) return grown.error();
  const Image first_half = (*accumulation)->image();
  if (auto grown = (*accumulation)->growTo(options.reference_samples, step); !grown) return grown.error();
  reference.image = (*accumulation)->image();
  reference.noise = noiseFloor(first_half, rest(reference.image, options.reference_samples, first_half, half));
  reference.pixels = displayed((*accumulation)->pixels());
  reference.seen.emplace(reference.pixels.data(), options.width, options.height);
  return reference;
}

/// What each frame of a run is measured against: in flight every frame has a reference of its own.
struct References {
  std::vector<Reference> frames;  // of the run's frames from the last backwards; one where the camera stands
  MotionField motion;             // of the last frame
  const Reference& last() const { return frames.front(); }
  const Reference& of(uint32_t left) const { return frames[std::min<size_t>(left, frames.size() - 1)]; }
};

Result<References> renderReferences(render::Renderer& renderer, const scene::ScenePtr& scene,
                                    const scene::NamedCamera& camera, const AccuracyOptions& options) {
  References references;
  const uint32_t frames = options.motion == MotionKind::fly ? options.frames : 1;
  for (uint32_t left = 0; left < frames; ++left) {
    scene::NamedCamera there = camera;
    there.camera = cameraBefore(camera.camera, options.motion, left);
    const std::optional<float> exposure = left > 0 ? std::optional<float>(references.last().exposure_ev) : std::nullopt;
    auto reference = renderReference(renderer, scene, there, exposure, options);
    if (!reference) return reference.error();
    references.frames.push_back(std::move(*reference));
  }
  auto motion = motionOfLastFrame(renderer, scene, camera, options);
  if (!motion) return motion.error();
  references.motion = std::move(*motion);
  return references;
}

/// The middle of a picture, as much as the page shows of it.
Result<std::string> png(const std::vector<uint8_t>& rgba, const AccuracyOptions& options) {
  const uint32_t width = std::min(options.width, kCropWidth), height = std::min(options.height, kCropHeight);
  const uint32_t left = (options.width - width) / 2, top = (options.height - height) / 2;
  std::vector<uint8_t> crop;
  for (uint32_t y = top; y < top + height; ++y) {
    const auto* row = rgba.data() + 4 * (size_t{y} * options.width + left);
    crop.insert(crop.end(), row, row + 4 * size_t{width});
  }
  return stream::encodePng({crop.data(), width, height});
}

/// The medians of times, collected tick by tick.
class Times {
 public:
  void add(const render::FrameStats& stats) {
    frames_.push_back(stats.gpu_ms);
    for (const render::PassTime& pass : stats.passes) {
      auto row = std::find_if(passes_.begin(), passes_.end(), [&](const auto& p) { return p.first == pass.name; });
      if (row == passes_.end()) row = passes_.insert(row, {pass.name, {}});
      row->second.push_back(pass.ms);
    }
  }
  void summariseInto(AccuracyPoint& point) const {
    point.frame_ms = summarise(frames_);
    for (const auto& [name, times] : passes_) point.passes.emplace_back(name, summarise(times));
  }

 private:
  std::vector<double> frames_;
  std::vector<std::pair<std::string, std::vector<double>>> passes_;
};

/// `name`: axis_setting, or reference.
Result<void> writePfm(const AccuracyOptions& options, const std::string& name, const Image& image) {
  if (!options.pfm) return {};
  return writeFile((fs::path(options.out) / (name + ".pfm")).string(),
                   stream::encodePfm(image.rgb, image.width, image.height));
}

Result<AccuracyPoint> measureSetting(render::Renderer& renderer, const scene::ScenePtr& scene,
                                     const scene::NamedCamera& camera, const AccuracySetting& setting,
                                     const References& references, const AccuracyOptions& options) {
  const Reference& reference = references.last();
  auto viewed = test::ViewedWorld::open(renderer, scene);
  if (!viewed) return viewed.error();
  if (auto lit = (*viewed)->setLight(camera.environment); !lit) return lit.error();
  if (setting.culling)
    if (auto set = renderer.setCulling((*viewed)->handle(), *setting.culling); !set) return set.error();
  const bool guided = setting.culling == render::Culling::lipac;
  render::ViewSettings view = setting.view;
  view.exposure_ev = reference.exposure_ev;
  // Another light transport forgets all history, while random numbers go on.
  render::ViewSettings forgetful = view;
  forgetful.round_surfaces = !view.round_surfaces;

  if (guided) {
    for (uint32_t tick = 0; tick < kTicksUntilCulled; ++tick)
      if (auto shown = (*viewed)->tick(camera.camera, view, 0.0); !shown) return shown.error();
    if (auto frozen = renderer.freezeCulling((*viewed)->handle(), true); !frozen) return frozen.error();
  }

  AccuracyPoint point{setting.axis, setting.name};
  Times times;
  std::vector<Image> last;
  double flicker = 0.0;
  point.recovery.resize(options.frames);
  for (uint32_t run = 0; run < options.runs; ++run) {
    if (auto forgotten = (*viewed)->tick(camera.camera, forgetful, 0.0); !forgotten) return forgotten.error();
    if (options.motion == MotionKind::jump)
      for (uint32_t tick = 0; tick < kTicksElsewhere; ++tick)
        if (auto shown = (*viewed)->tick(cameraElsewhere(camera.camera), view, 0.0); !shown) return shown.error();
    std::vector<uint8_t> before, now;
    for (uint32_t frame = 0; frame < options.frames; ++frame) {
      const uint32_t left = options.frames - 1 - frame;
      auto shown = (*viewed)->tick(cameraBefore(camera.camera, options.motion, left), view, 0.0);
      if (!shown) return shown.error();
      const Image image{options.width, options.height, shown->radiance};
      point.recovery[frame] += relativeMse(image, references.of(left).image) / options.runs;
      before = std::move(now);
      now = displayed(*shown->pixels);
      if (run + 1 == options.runs)  // one run is enough for what is displayed: its pixels are many
        point.ssim_along.push_back(ssim(lumas(now), lumas(references.of(left).pixels), options.width, options.height));
      if (left > 0) continue;
      last.push_back(image);
      if (const auto& variance = shown->stats.variance)
        point.estimated_variance = point.estimated_variance.value_or(0.0) + *variance / options.runs;
      const render::MemoryUse& memory = shown->stats.memory;
      point.memory_bytes = memory.raster + memory.ray_tracing + memory.path_tracing;
      point.history_bytes = shown->stats.history_bytes;
    }
    if (!before.empty())
      flicker += meanChange(before, now, references.motion, options.width, options.height) / options.runs;
    if (run + 1 < options.runs) continue;
    point.ssim = point.ssim_along.back();
    const std::vector<float> differences =
        reference.seen->differences(SeenPicture(now.data(), options.width, options.height));
    point.flip = std::accumulate(differences.begin(), differences.end(), 0.0) / static_cast<double>(differences.size());
    auto picture = png(now, options), error = png(heat(differences), options);
    if (!picture) return picture.error();
    if (!error) return error.error();
    point.picture_png = std::move(*picture);
    point.error_png = std::move(*error);
  }
  if (guided)
    if (auto thawed = renderer.freezeCulling((*viewed)->handle(), false); !thawed) return thawed.error();
  // Times are of ticks without work between them: a GPU that waits while pictures are compared slows its clock.
  const uint32_t settling = renderer.device().cpu ? 1 : kSettlingTicks, timed = std::max(options.frames, kTimedTicks);
  for (uint32_t tick = 0; tick < settling + timed; ++tick) {
    const uint32_t left = options.frames - 1 - tick % options.frames;
    auto shown = (*viewed)->tick(cameraBefore(camera.camera, options.motion, left), view, 0.0);
    if (!shown) return shown.error();
    if (tick >= settling) times.add(shown->stats);
  }
  times.summariseInto(point);
  point.error = decompose(last, reference.image);
  if (auto written = writePfm(options, setting.axis + "_" + setting.name, last.back()); !written)
    return written.error();
  if (options.frames > 1) point.flicker = flicker;
  return point;
}

/// Leaves the settings that have one of these names; none: all.
Result<void> leaveOnly(const std::vector<std::string>& names, std::vector<AccuracySetting>& settings) {
  for (const std::string& name : names)
    if (std::none_of(settings.begin(), settings.end(), [&](const AccuracySetting& s) { return s.name == name; }))
      return invalid("--setting", name, "none of the axes has a setting \"" + name + "\": see the tables of a report");
  if (!names.empty())
    std::erase_if(settings, [&](const AccuracySetting& s) {
      return std::find(names.begin(), names.end(), s.name) == names.end();
    });
  return {};
}

Result<void> measure(const AccuracyOptions& options, const std::string& command_line) {
  if (auto valid = check(options.stage); !valid) return valid;
  std::vector<AccuracySetting> settings;
  const bool all =
      options.axes.empty() || std::find(options.axes.begin(), options.axes.end(), "all") != options.axes.end();
  render::ViewSettings base = baseSettings(options.width, options.height);
  if (auto applied = apply(options.settings, base); !applied) return applied;
  for (const std::string& axis : all ? accuracyAxes() : options.axes) {
    auto of_axis = settingsOf(axis, base);
    if (!of_axis) return of_axis.error();
    settings.insert(settings.end(), of_axis->begin(), of_axis->end());
  }
  if (auto left = leaveOnly(options.only, settings); !left) return left;
  std::error_code error;
  fs::create_directories(options.out, error);
  if (error) return invalid("--out", options.out, "cannot make the folder " + options.out + ": " + error.message());
  auto scene = makeScene(options.stage);
  if (!scene) return scene.error();
  const auto named = findCamera(**scene, options.stage.camera);
  if (!named) return named.error();
  scene::NamedCamera camera = **named;
  if (options.mirror) {
    scene = withMirror(**scene, camera.camera);
    camera.name += " in a mirror";
  }
  auto renderer = render::makeRenderer(options.renderer);
  if (!renderer) return renderer.error();

  AccuracyReport report;
  report.provenance = provenance((*renderer)->device(), command_line);
  report.scene = (*scene)->name;
  report.camera = camera.name;
  report.options = options;
  auto references = renderReferences(**renderer, *scene, camera, options);
  if (!references) return references.error();
  const Reference* reference = &references->last();
  if (references->frames.size() > 1)
    report.reference_flicker =
        meanChange(references->of(1).pixels, reference->pixels, references->motion, options.width, options.height);
  report.reference_noise = reference->noise;
  report.exposure_ev = static_cast<double>(reference->exposure_ev);
  if (auto written = writePfm(options, "reference", reference->image); !written) return written;
  auto reference_png = png(reference->pixels, options);
  if (!reference_png) return reference_png.error();
  report.reference_png = std::move(*reference_png);
  {
    Progress progress("settings", settings.size());
    for (const AccuracySetting& setting : settings) {
      auto point = measureSetting(**renderer, *scene, camera, setting, *references, options);
      if (!point) return point.error();
      report.points.push_back(std::move(*point));
      progress.step();
    }
  }
  const std::string stem = (fs::path(options.out) / "accuracy").string(), document = toJson(report).dump(2) + "\n";
  for (const auto& [ending, bytes] : {std::pair{".html", toHtml(report)}, {".csv", toCsv(report)}, {".json", document}})
    if (auto written = writeFile(stem + ending, bytes); !written) return written;
  std::cout << (options.json ? document : toMarkdown(report)) << std::flush;
  if (!std::cout) return Error{ErrorKind::internal, "cannot write the result to standard output", {}, {}, {}};
  return {};
}

}  // namespace

Decomposition decompose(const std::vector<Image>& pictures, const Image& truth) {
  const auto n = static_cast<double>(pictures.size()), values = static_cast<double>(truth.rgb.size());
  Decomposition result;
  for (size_t i = 0; i < truth.rgb.size(); ++i) {
    const double value = static_cast<double>(truth.rgb[i]);
    double sum = 0.0, squares = 0.0;
    for (const Image& picture : pictures) {
      const double difference = static_cast<double>(picture.rgb[i]) - value;
      sum += difference;
      squares += difference * difference;
    }
    const double unit = (value * value + kEpsilon) * values;
    result.total += squares / n / unit;
    result.variance += (squares - sum * sum / n) / (n - 1.0) / unit;
  }
  result.bias = result.total - result.variance;
  return result;
}

void addAccuracyCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<AccuracyOptions>();
  CLI::App& command = *app.add_subcommand("accuracy", "what each approximation saves, and what it does to the picture");
  command.footer(kNotes);
  addStageOptions(command, options->stage);
  addSizeOption(command, options->width, options->height);
  std::string axes = "all";
  for (const std::string& axis : accuracyAxes()) axes += ", " + axis;
  command.add_option("--axis", options->axes, "what to vary, any number of times: " + axes);
  command.add_option("--setting", options->only, "of the axes these settings alone, any number of times");
  const std::map<std::string, MotionKind> motions{
      {"still", MotionKind::still}, {"fly", MotionKind::fly}, {"jump", MotionKind::jump}};
  command.add_option("--motion", options->motion, "of the camera during a run: still, fly or jump")
      ->transform(CLI::CheckedTransformer(motions))
      ->default_str("still");
  command.add_option("--frames", options->frames, "of a run, the last of which is judged")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--runs", options->runs, "with random numbers of their own")
      ->check(CLI::Range(2, 1000))
      ->capture_default_str();
  command.add_option("--reference-spp", options->reference_samples, "samples a pixel of the reference")
      ->check(CLI::Range(2, 1'000'000))
      ->capture_default_str();
  command.add_option("--reference-bounces", options->reference_bounces, "of the reference")
      ->check(CLI::Range(0, 32))
      ->capture_default_str();
  command.add_option("--out", options->out, "a folder for the report")->capture_default_str();
  addSettingOptions(command, options->settings);
  command.add_flag("--mirror", options->mirror, "looks into a mirror that shows the camera's view");
  command.add_flag("--pfm", options->pfm,
                   "also writes linear radiance: the reference, and each setting's last picture");
  addDeviceOptions(command, options->renderer);
  command.add_flag("--json", options->json, "print one JSON document");
  command.callback([options, command_line, &chosen] {
    chosen = [options, command_line] { return measure(*options, command_line); };
  });
}

}  // namespace helio::bench
