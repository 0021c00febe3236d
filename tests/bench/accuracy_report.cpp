#include <algorithm>
#include <cmath>
#include <numeric>

#include "bench/accuracy.h"

namespace helio::bench {
namespace {

std::string percent(double share) { return std::to_string(std::lround(100.0 * std::abs(share))) + " %"; }

/// "costs 1.9 ms (+31 %)"
std::string costOf(const AccuracyPoint& from, const AccuracyPoint& to) {
  const double ms = to.frame_ms.median - from.frame_ms.median;
  return (ms >= 0.0 ? "costs " : "saves ") + shown(std::abs(ms)) + " ms (" + percent(ms / from.frame_ms.median) +
         " of a frame)";
}

std::string gainOf(const AccuracyPoint& from, const AccuracyPoint& to) {
  const double change = to.error.total / from.error.total - 1.0;
  if (std::abs(change) < 0.005) return "changes nothing about the error";
  return (change < 0.0 ? "takes " : "adds ") + percent(change) + " of the error";
}

}  // namespace

const char* name(MotionKind motion) {
  return motion == MotionKind::still ? "still" : motion == MotionKind::fly ? "fly" : "jump";
}

std::vector<size_t> paretoFront(const std::vector<AccuracyPoint>& points) {
  std::vector<size_t> order(points.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return std::pair(points[a].frame_ms.median, points[a].error.total) <
           std::pair(points[b].frame_ms.median, points[b].error.total);
  });
  std::vector<size_t> front;
  for (const size_t i : order)
    if (front.empty() || points[i].error.total < points[front.back()].error.total) front.push_back(i);
  return front;
}

std::string sentence(const std::vector<AccuracyPoint>& axis) {
  std::string text;
  for (size_t i = 1; i < axis.size(); ++i)
    text += (text.empty() ? "" : " ") + std::string("From ") + axis[i - 1].name + " to " + axis[i].name + ": " +
            costOf(axis[i - 1], axis[i]) + " and " + gainOf(axis[i - 1], axis[i]) + ".";
  const AccuracyPoint& last = axis.back();
  if (last.error.total > 0.0)
    text += (text.empty() ? "" : " ") + std::string("Of what ") + last.name + " leaves, " +
            percent(std::clamp(last.error.bias / last.error.total, 0.0, 1.0)) + " is bias.";
  return text;
}

Json toJson(const AccuracyReport& report) {
  const AccuracyOptions& o = report.options;
  Json json{{"schema", "heliograph.bench.accuracy/1"}};
  append(json, report.provenance);
  json["scene"] = report.scene;
  json["camera"] = report.camera;
  json["width"] = o.width;
  json["height"] = o.height;
  json["motion"] = name(o.motion);
  json["frames"] = o.frames;
  json["runs"] = o.runs;
  json["exposure_ev"] = report.exposure_ev;
  json["reference_flicker"] = report.reference_flicker ? Json(*report.reference_flicker) : Json();
  json["reference"] = {
      {"samples", o.reference_samples}, {"bounces", o.reference_bounces}, {"noise", report.reference_noise}};
  json["points"] = Json::array();
  for (const AccuracyPoint& p : report.points) {
    Json point{{"axis", p.axis},
               {"name", p.name},
               {"frame_ms", p.frame_ms.median},
               {"frame_ms_p95", p.frame_ms.p95},
               {"relmse", p.error.total},
               {"bias", p.error.bias},
               {"variance", p.error.variance},
               {"estimated_variance", p.estimated_variance ? Json(*p.estimated_variance) : Json()},
               {"ssim", p.ssim},
               {"flip", p.flip},
               {"flicker", p.flicker ? Json(*p.flicker) : Json()},
               {"memory_bytes", p.memory_bytes},
               {"history_bytes", p.history_bytes},
               {"recovery", p.recovery},
               {"ssim_along", p.ssim_along}};
    for (const auto& [pass, ms] : p.passes) point["passes"][pass] = {{"median_ms", ms.median}, {"p95_ms", ms.p95}};
    json["points"].push_back(std::move(point));
  }
  return json;
}

std::string toMarkdown(const AccuracyReport& report) {
  Table table(
      {"setting", "frame ms", "p95", "relative MSE", "bias", "variance", "SSIM", "FLIP", "flicker", "history MB"});
  for (const AccuracyPoint& p : report.points)
    table.add({p.axis + " " + p.name, fixed(p.frame_ms.median, 2), fixed(p.frame_ms.p95, 2), shown(p.error.total),
               shown(p.error.bias), shown(p.error.variance), fixed(p.ssim, 3), fixed(p.flip, 3),
               p.flicker ? fixed(*p.flicker, 4) : "", megabytes(p.history_bytes)});
  const AccuracyOptions& o = report.options;
  std::string text =
      markdown(report.provenance) + "- scene: " + report.scene + ", camera " + report.camera + ", " +
      std::to_string(o.width) + " x " + std::to_string(o.height) + ", " + name(o.motion) + ", frame " +
      std::to_string(o.frames) + " of " + std::to_string(o.runs) +
      " runs\n- reference: " + grouped(o.reference_samples) + " samples, " + std::to_string(o.reference_bounces) +
      " bounces, relative MSE from its own noise " + shown(report.reference_noise) +
      (report.reference_flicker ? ", flicker along the motion " + fixed(*report.reference_flicker, 4) : std::string()) +
      "\n\n" + table.markdown();
  return text;
}

std::string toCsv(const AccuracyReport& report) {
  std::string text =
      "axis,name,frame_ms,frame_ms_p95,relmse,bias,variance,ssim,flip,flicker,memory_bytes,history_bytes\n";
  for (const AccuracyPoint& p : report.points) {
    text += p.axis + "," + p.name;
    for (const double value :
         {p.frame_ms.median, p.frame_ms.p95, p.error.total, p.error.bias, p.error.variance, p.ssim, p.flip}) {
      char number[32];
      std::snprintf(number, sizeof number, ",%.9g", value);
      text += number;
    }
    text += "," + (p.flicker ? std::to_string(*p.flicker) : std::string()) + "," + std::to_string(p.memory_bytes) +
            "," + std::to_string(p.history_bytes) + "\n";
  }
  return text;
}

}  // namespace helio::bench
