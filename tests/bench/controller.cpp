#include "bench/controller.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <memory>

#include "bench/culled_world.h"
#include "bench/flight.h"
#include "bench/plot.h"
#include "bench/progress.h"
#include "bench/report.h"
#include "bench/statistics.h"
#include "render/controller.h"
#include "render/reference.h"
#include "service/price_file.h"
#include "support/viewed_world.h"

namespace helio::bench {
namespace {

using render::Goal;

constexpr const char* kNotes = R"(What is measured:
  A viewer with a goal while the camera flies, turns and tilts quickly, from --camera and back to it. The controller
  chooses every tick's preset by the ticks before, as a server's does. With --judge-every N the true error of every Nth
  frame is found behind the flight, against a reference of --reference-spp samples at the same place and world time.

Examples:
  helio-bench controller --max-frame-ms 16 --instances 10000 --size 1920x1080 --frames 1200 --device NVIDIA --json
  helio-bench controller --max-error 0.1 --judge-every 20 --size 1920x1080 --device NVIDIA --prices out/accuracy/accuracy.json
  helio-bench controller --max-frame-ms 400 --instances 1000 --size 160x90 --frames 200 --plot controller.svg)";

struct ControllerOptions {
  CullingStage common;
  double max_frame_ms = 0.0, max_error = 0.0;
  uint32_t frames = 600, warmup = 20, judge_every = 0, reference_samples = 128, reference_bounces = 8;
  std::string prices;

  Goal goal() const {
    return max_frame_ms > 0.0 ? Goal{Goal::Kind::max_frame_ms, max_frame_ms} : Goal{Goal::Kind::max_error, max_error};
  }
};

struct Flown {
  double ms;
  size_t rung;
  double predicted_ms;
  double believed;  // error
  std::optional<double> true_error;
};

/// A picture to judge when the flight is over: rendering references meanwhile would change the times.
struct Taken {
  size_t frame;
  scene::Camera camera;
  double time;
  render::ViewSettings settings;
  Image image;
};

struct Flight {
  std::vector<Flown> frames;
  std::vector<Taken> taken;
};

Result<Flight> fly(const ControllerOptions& options, const OpenStage& stage, const render::PriceList& prices,
                   const render::ViewSettings& wanted) {
  auto world = test::ViewedWorld::open(*stage.renderer, stage.scene);
  if (!world) return world.error();
  if (auto lit = (*world)->setLight(stage.camera->environment); !lit) return lit.error();
  render::Controller controller(prices, options.goal());
  Flight flight;
  Progress progress("flying", options.warmup + options.frames);
  for (uint32_t t = 0; t < options.warmup + options.frames; ++t, progress.step()) {
    const double share = t < options.warmup ? 0.0 : double(t - options.warmup) / options.frames;
    const size_t rung = controller.decision().rung;
    const render::ViewSettings settings = render::onRung(wanted, rung);
    const scene::Camera camera = along(stage.camera->camera, share);
    auto frame = (*world)->tick(camera, settings, CulledWorld::kTick);
    if (!frame) return frame.error();
    const double predicted = controller.decision().predicted_ms;
    controller.observe(render::observe(frame->stats, settings));
    if (t < options.warmup) continue;
    const auto belief = render::believe(prices, settings, frame->stats);
    flight.frames.push_back(
        {frame->stats.gpu_ms, rung, predicted, belief ? belief->variance + belief->bias : 0.0, std::nullopt});
    if (options.judge_every > 0 && flight.frames.size() % options.judge_every == 0)
      flight.taken.push_back(
          {flight.frames.size() - 1, camera, frame->stats.time, settings, imageOf(std::move(*frame))});
  }
  return flight;
}

/// The true errors of what was taken, by a world of its own at the same times.
Result<void> judge(const ControllerOptions& options, const OpenStage& stage, Flight& flight) {
  auto world = test::ViewedWorld::open(*stage.renderer, stage.scene);
  if (!world) return world.error();
  if (auto lit = (*world)->setLight(stage.camera->environment); !lit) return lit.error();
  Progress progress("references", flight.taken.size());
  double now = 0.0;
  for (const Taken& taken : flight.taken) {
    render::ViewSettings settings = render::referenceOf(taken.settings, options.reference_bounces, 1.0);
    settings.samples = 1;
    render::Frame frame;
    while (frame.stats.accumulated < options.reference_samples || frame.radiance.empty()) {
      auto next = (*world)->tick(taken.camera, settings, taken.time - now);
      if (!next) return next.error();
      frame = std::move(*next);
      now = taken.time;
    }
    flight.frames[taken.frame].true_error = relativeMse(taken.image, imageOf(std::move(frame)));
    progress.step();
  }
  return {};
}

double shareOf(const std::vector<bool>& holds) {
  return holds.empty()
             ? 0.0
             : static_cast<double>(std::count(holds.begin(), holds.end(), true)) / static_cast<double>(holds.size());
}

std::string percent(double share) { return fixed(100.0 * share, 1) + " %"; }

Result<void> measureController(const ControllerOptions& options, const std::string& command_line) {
  if ((options.max_frame_ms > 0.0) == (options.max_error > 0.0))
    return invalid("--max-frame-ms", fmt::format("{}", options.max_frame_ms),
                   "give one goal: --max-frame-ms or --max-error");
  auto wanted = viewSettings(options.common);
  if (!wanted) return wanted.error();
  wanted->keep_radiance = options.judge_every > 0;
  const auto stage = openStage(options.common);
  if (!stage) return stage.error();
  const Provenance source = provenance(stage->renderer->device(), command_line);
  auto prices = options.prices.empty() ? Result<render::PriceList>(render::usualPrices())
                                       : service::readPriceList(options.prices);
  if (!prices) return prices.error();
  auto flight = fly(options, *stage, *prices, *wanted);
  if (!flight) return flight.error();
  if (auto judged = judge(options, *stage, *flight); !judged) return judged;

  std::vector<double> ms, believed, true_errors;
  std::vector<bool> in_time, as_quick_as_can_be, within_twice;
  std::array<size_t, render::kRungs> on_rung{};
  size_t moves = 0;
  Series times{"frame, GPU ms", {}}, rungs{"rung", {}}, errors{"true error", {}}, beliefs{"believed error", {}};
  Json series = {{"ms", Json::array()}, {"rung", Json::array()}, {"believed", Json::array()}, {"true", Json::array()}};
  for (size_t i = 0; i < flight->frames.size(); ++i) {
    const Flown& frame = flight->frames[i];
    const double second = static_cast<double>(i) * CulledWorld::kTick;
    ms.push_back(frame.ms);
    believed.push_back(frame.believed);
    in_time.push_back(frame.ms <= options.max_frame_ms);
    as_quick_as_can_be.push_back(in_time.back() || frame.rung == 0);
    ++on_rung[frame.rung];
    moves += i > 0 && frame.rung != flight->frames[i - 1].rung;
    times.points.emplace_back(second, frame.ms);
    rungs.points.emplace_back(second, static_cast<double>(frame.rung));
    beliefs.points.emplace_back(second, frame.believed);
    series["ms"].push_back(frame.ms);
    series["rung"].push_back(frame.rung);
    series["believed"].push_back(frame.believed);
    series["true"].push_back(frame.true_error ? Json(*frame.true_error) : Json());
    if (!frame.true_error) continue;
    errors.points.emplace_back(second, *frame.true_error);
    true_errors.push_back(*frame.true_error);
    within_twice.push_back(*frame.true_error <= 2.0 * options.max_error);
  }
  const Summary time = summarise(ms), belief = summarise(believed), truth = summarise(true_errors);
  const bool by_time = options.max_frame_ms > 0.0;

  Json json = {{"schema", "heliograph.bench.controller/1"}};
  append(json, source);
  json["camera"] = stage->camera->name;
  json["instances"] = stage->scene->placements.size();
  json["width"] = options.common.width;
  json["height"] = options.common.height;
  json["goal"] = {{"max_frame_ms", by_time ? Json(options.max_frame_ms) : Json()},
                  {"max_error", by_time ? Json() : Json(options.max_error)}};
  json["prices"] = prices->source;
  json["frame_ms"] = {{"median", time.median}, {"p95", time.p95}};
  json["in_time"] = by_time ? Json(shareOf(in_time)) : Json();
  json["in_time_or_quickest"] = by_time ? Json(shareOf(as_quick_as_can_be)) : Json();
  json["believed_error"] = {{"median", belief.median}, {"p95", belief.p95}};
  json["true_error"] = true_errors.empty() ? Json() : Json{{"median", truth.median}, {"p95", truth.p95}};
  json["within_twice"] = by_time || true_errors.empty() ? Json() : Json(shareOf(within_twice));
  json["moves"] = moves;
  for (size_t rung = 0; rung < render::kRungs; ++rung)
    json["presets"][render::kLadder[rung].name] = static_cast<double>(on_rung[rung]) / static_cast<double>(ms.size());
  json["series"] = std::move(series);

  std::string text =
      fmt::format("# Controller: {}, {} instances, {}x{}, {} ticks of flight, {} {}\n\n", stage->camera->name,
                  grouped(stage->scene->placements.size()), options.common.width, options.common.height, options.frames,
                  by_time ? "max_frame_ms" : "max_error", options.goal().value);
  text += markdown(source) + "- prices: " + prices->source + "\n\n";
  Table table({"", "median", "95th percentile", "worst"});
  const auto row = [&](const char* label, const std::vector<double>& values, const Summary& summary) {
    if (!values.empty())
      table.add(
          {label, shown(summary.median), shown(summary.p95), shown(*std::max_element(values.begin(), values.end()))});
  };
  row("frame, GPU ms", ms, time);
  row("believed error", believed, belief);
  row("true error", true_errors, truth);
  text += table.markdown() + "\n";
  if (by_time)
    text += fmt::format("{} of frames took no more than {} ms, {} with those on the quickest preset. ",
                        percent(shareOf(in_time)), options.max_frame_ms, percent(shareOf(as_quick_as_can_be)));
  else if (!true_errors.empty())
    text += fmt::format("{} of {} judged frames have an error of no more than twice {}. ",
                        percent(shareOf(within_twice)), true_errors.size(), options.max_error);
  text += fmt::format("{} changes of preset:", moves);
  for (size_t rung = 0; rung < render::kRungs; ++rung)
    text += fmt::format(" {} {}", render::kLadder[rung].name,
                        percent(static_cast<double>(on_rung[rung]) / double(ms.size())));
  text += "\n";
  const std::vector<Chart> charts{{"GPU, ms", "seconds", {times}},
                                  {"Rung", "seconds", {rungs}},
                                  {"Relative mean square error", "seconds", {beliefs, errors}}};
  return publish(options.common, json.dump(2), text, toSvg(charts));
}

}  // namespace

void addControllerCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<ControllerOptions>();
  CLI::App& command = *app.add_subcommand("controller", "what a viewer's goal comes to over a quick flight");
  command.footer(kNotes);
  addCullingStageOptions(command, options->common, "heliograph.bench.controller/1");
  auto* time = command.add_option("--max-frame-ms", options->max_frame_ms, "goal: GPU milliseconds a frame")
                   ->check(CLI::Range(1e-3, 10'000.0).description(""));
  command.add_option("--max-error", options->max_error, "goal: relative mean square error")
      ->check(CLI::Range(1e-6, 10.0).description(""))
      ->excludes(time);
  command.add_option("--frames", options->frames, "of the whole path, 2 to 10,000")
      ->capture_default_str()
      ->check(CLI::Range(2, 10'000).description(""));
  command.add_option("--warmup", options->warmup, "ticks at its start, which do not count")->capture_default_str();
  command
      .add_option("--judge-every", options->judge_every, "frames: one of so many is compared with a reference; 0: none")
      ->capture_default_str();
  command.add_option("--reference-spp", options->reference_samples, "samples a pixel of those references")
      ->capture_default_str()
      ->check(CLI::Range(1, 65'536).description(""));
  command.add_option("--reference-bounces", options->reference_bounces, "of those references")
      ->capture_default_str()
      ->check(CLI::Range(0, 32).description(""));
  command.add_option("--prices", options->prices,
                     "accuracy.json of helio-bench accuracy --axis preset; default: the list of the program");
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureController(*options, command_line); };
  });
}

}  // namespace helio::bench
