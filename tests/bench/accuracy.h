// `helio-bench accuracy`: what each approximation saves and what it does to the picture, on one scene in one run.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/command.h"
#include "bench/image.h"
#include "bench/report.h"
#include "bench/stage.h"
#include "bench/statistics.h"
#include "render/renderer.h"

namespace helio::bench {

enum class MotionKind {
  still,  ///< the camera stands; each run begins without a history
  fly,    ///< the camera comes sideways to where the reference looks from, and is there in a run's last frame
  jump,   ///< the camera stood elsewhere and jumps: each run begins with a history of what is not to be seen
};

struct AccuracyOptions {
  StageOptions stage;
  uint32_t width = 320, height = 180;
  std::vector<std::string> axes;  ///< empty: all
  std::vector<std::string> only;  ///< settings of them; empty: all
  MotionKind motion = MotionKind::still;
  uint32_t frames = 8;  ///< of a run: its last one is judged
  uint32_t runs = 8;    ///< with random numbers of their own: what they share is bias
  uint32_t reference_samples = 1024;
  uint32_t reference_bounces = 8;
  std::string out = "out/accuracy";
  std::vector<std::string> settings;  ///< NAME=VALUE, of the base that every axis changes one thing of
  bool mirror = false;                ///< the camera looks into a mirror that shows its view
  bool pfm = false;  ///< also writes the linear radiance of the reference and of each setting's last run
  render::RendererOptions renderer;
  bool json = false;
};

/// Pixels of the pictures on the page, the middle of larger ones: as its style says.
inline constexpr uint32_t kCropWidth = 320, kCropHeight = 180;

/// One value of one axis; everything else is as in baseSettings().
struct AccuracySetting {
  std::string axis, name;
  render::ViewSettings view;
  std::optional<render::Culling> culling;  ///< nothing: full
};

/// The axes in the order of the report.
const std::vector<std::string>& accuracyAxes();
/// One path a pixel, three bounces, everything traced that can be: what every axis changes one thing of.
render::ViewSettings baseSettings(uint32_t width, uint32_t height);
/// The settings of one axis, the cheapest first. Errors (invalid): no such axis.
Result<std::vector<AccuracySetting>> settingsOf(const std::string& axis, const render::ViewSettings& base);

/// A mean square error and its parts: bias is what is left when infinitely many runs are averaged.
struct Decomposition {
  double total = 0.0, bias = 0.0, variance = 0.0;  ///< total = bias + variance
};
/// Of pictures with independent noise against the truth, each square over truth^2 + 0.01. At least two pictures. The
/// bias is estimated without bias, so it may come out below zero by chance.
Decomposition decompose(const std::vector<Image>& pictures, const Image& truth);

/// A measured setting. Errors are of a run's last frame.
struct AccuracyPoint {
  std::string axis, name;
  Summary frame_ms;
  std::vector<std::pair<std::string, Summary>> passes;  ///< ms by pass, in the order of the frame
  Decomposition error;
  std::optional<double> estimated_variance;  ///< as the denoiser believed, mean over runs
  double ssim = 0.0, flip = 0.0;             ///< of the last run
  /// Mean change of displayed luma from a run's last frame but one to its last, [0, 1]; in flight along the motion.
  std::optional<double> flicker;
  uint64_t memory_bytes = 0;   ///< all GPU memory while it ran
  uint64_t history_bytes = 0;  ///< what the view keeps of the ticks before, and its denoiser
  // After 1, 2, ... frames of a run, against the reference from where that frame looks.
  std::vector<double> recovery;    ///< relative MSE, mean over runs
  std::vector<double> ssim_along;  ///< of the last run
  std::string picture_png, error_png;
};

struct AccuracyReport {
  Provenance provenance;
  std::string scene, camera;
  AccuracyOptions options;
  std::optional<double> reference_flicker;  ///< the reference's own change along the motion, in flight
  double reference_noise = 0.0;             ///< relative MSE that the reference has from noise alone
  double exposure_ev = 0.0;                 ///< of all displayed pictures
  std::string reference_png;
  std::vector<AccuracyPoint> points;
};

const char* name(MotionKind motion);
/// The points that no other point beats in both time and error, by time.
std::vector<size_t> paretoFront(const std::vector<AccuracyPoint>& points);
/// What the steps of an axis cost and bring, in words.
std::string sentence(const std::vector<AccuracyPoint>& axis);

Json toJson(const AccuracyReport& report);
std::string toMarkdown(const AccuracyReport& report);
std::string toCsv(const AccuracyReport& report);
/// One file that needs no other.
std::string toHtml(const AccuracyReport& report);

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addAccuracyCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
