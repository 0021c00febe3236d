#include <absl/strings/escaping.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy.h"

namespace helio::bench {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.5 system-ui, sans-serif; color: #1b2733; background: #f6f7f9; margin: 2rem auto; max-width: 76rem; padding: 0 1rem }
h1 { font-size: 1.7rem; margin: 0 } h2 { font-size: 1.2rem; margin: 0 0 .3rem } code { font-size: .85em; overflow-wrap: anywhere }
.about { color: #5b6774; margin: .2rem 0 }
section { background: #fff; border: 1px solid #dde2e8; border-radius: 8px; padding: 1rem 1.2rem; margin: 1rem 0; break-inside: avoid }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; margin: .6rem 0 }
td, th { padding: .15rem .7rem; text-align: right; font-weight: normal; border-top: 1px solid #eef1f4 }
th { color: #5b6774; font-size: .85rem; border: 0 } td:first-child, th:first-child { text-align: left }
.pictures { display: grid; grid-template-columns: repeat(3, minmax(0, 1fr)); gap: .8rem; align-items: start }
.pictures > :first-child { position: sticky; top: .8rem } figure { margin: 0 } figcaption { font-size: .85rem; color: #5b6774 }
.crop { box-sizing: border-box; width: 100%; aspect-ratio: 16 / 9; background-position: center; background-repeat: no-repeat; border: 1px solid #dde2e8; }
.small { image-rendering: pixelated; background-size: contain }
svg { background: #fff; border: 1px solid #dde2e8; border-radius: 8px; width: 100%; height: auto } svg text { font-size: 12px; fill: #1b2733 }
.grid { stroke: #e6eaee } .axis { fill: #5b6774 } .front { fill: none; stroke: #1f6fb2; stroke-width: 2; opacity: .5 }
)";
constexpr const char* kColours[] = {"#1f6fb2", "#d1811c", "#2f9266", "#b03a8c", "#6b5bd2",
                                    "#8a6d3b", "#c0392b", "#16808a", "#7a7f87", "#4b8b1f"};

constexpr double kWidth = 960, kHeight = 460, kLeft = 64, kRight = 24, kTop = 20, kBottom = 46;

std::string number(double value) { return fixed(value, 1); }

/// A logarithmic axis over what there is, with room at both ends.
struct Scale {
  double low, high, from, to;
  double at(double value) const {
    return from + (to - from) * (std::log10(std::max(value, 1e-12)) - low) / std::max(high - low, 1e-9);
  }
};
template <typename F>
Scale scaleOf(const std::vector<AccuracyPoint>& points, const F& value, double from, double to) {
  double low = 1e30, high = -1e30;
  for (const AccuracyPoint& p : points) {
    const double v = std::log10(std::max(value(p), 1e-12));
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const double room = std::max(0.08 * (high - low), 0.05);
  return {low - room, high + room, from, to};
}

/// 1, 2 and 5 times powers of ten within the scale; where that is narrow, as many tenths of them as make three.
std::vector<double> ticksOf(const Scale& scale) {
  std::vector<double> ticks;
  const auto add = [&](double value) {
    if (std::log10(value) >= scale.low && std::log10(value) <= scale.high) ticks.push_back(value);
  };
  for (double decade = std::floor(scale.low); decade <= scale.high; ++decade)
    for (const double digit : {1.0, 2.0, 5.0}) add(digit * std::pow(10.0, decade));
  for (const int tenths : {10, 5, 2, 1}) {
    if (ticks.size() >= 3) break;
    ticks.clear();
    for (double decade = std::floor(scale.low); decade <= scale.high; ++decade)
      for (int digit = 10; digit < 100; digit += tenths) add(0.1 * digit * std::pow(10.0, decade));
  }
  return ticks;
}

std::string paretoPlot(const AccuracyReport& report) {
  const auto ms = [](const AccuracyPoint& p) { return p.frame_ms.median; };
  const auto error = [](const AccuracyPoint& p) { return p.error.total; };
  const Scale x = scaleOf(report.points, ms, kLeft, kWidth - kRight),
              y = scaleOf(report.points, error, kHeight - kBottom, kTop);
  std::string svg = "<svg viewBox='0 0 " + number(kWidth) + " " + number(kHeight) + "'>";
  for (const double tick : ticksOf(x))
    svg += "<line class=grid x1=" + number(x.at(tick)) + " x2=" + number(x.at(tick)) + " y1=" + number(kTop) +
           " y2=" + number(kHeight - kBottom) + " /><text class=axis text-anchor=middle x=" + number(x.at(tick)) +
           " y=" + number(kHeight - kBottom + 16) + ">" + shown(tick) + "</text>";
  for (const double tick : ticksOf(y))
    svg += "<line class=grid x1=" + number(kLeft) + " x2=" + number(kWidth - kRight) + " y1=" + number(y.at(tick)) +
           " y2=" + number(y.at(tick)) + " /><text class=axis text-anchor=end x=" + number(kLeft - 6) +
           " y=" + number(y.at(tick) + 4) + ">" + shown(tick) + "</text>";
  svg += "<text class=axis text-anchor=middle x=" + number(kWidth / 2) + " y=" + number(kHeight - 8) +
         ">milliseconds a frame, median</text>" + "<text class=axis transform='translate(16 " + number(kHeight / 2) +
         ") rotate(-90)' text-anchor=middle>relative MSE</text><path class=front d='";
  for (const size_t i : paretoFront(report.points))
    svg += (svg.back() == '\'' ? "M" : "L") + number(x.at(ms(report.points[i]))) + " " +
           number(y.at(error(report.points[i])));
  svg += "' />";
  // Labels that would lie on another go up a line.
  struct Label {
    double x, y;
  };
  std::vector<Label> placed;
  const std::vector<std::string>& axes = accuracyAxes();
  for (const AccuracyPoint& p : report.points) {
    const auto axis = static_cast<size_t>(std::find(axes.begin(), axes.end(), p.axis) - axes.begin());
    const char* colour = kColours[axis % std::size(kColours)];
    const double px = x.at(ms(p)), py = y.at(error(p));
    const bool left = px > kWidth - 160;
    Label label{left ? px - 8 : px + 8, py + 4};
    const auto taken = [&](const Label& other) {
      return std::abs(other.x - label.x) < 120 && std::abs(other.y - label.y) < 12;
    };
    for (int attempt = 0; attempt < 30 && std::any_of(placed.begin(), placed.end(), taken); ++attempt) {
      const int lines = (1 + attempt / 2) * (attempt % 2 ? -1 : 1);
      label.y = py + 4 + 13.0 * lines;
    }
    placed.push_back(label);
    if (std::abs(label.y - py - 4) > 1)
      svg += "<line class=grid x1=" + number(px) + " y1=" + number(py) + " x2=" + number(label.x) +
             " y2=" + number(label.y - 4) + " />";
    svg += "<circle r=4.5 fill='" + std::string(colour) + "' cx=" + number(px) + " cy=" + number(py) + " /><text" +
           (left ? " text-anchor=end" : "") + " x=" + number(label.x) + " y=" + number(label.y) + ">" +
           escaped(p.axis + " " + p.name) + "</text>";
  }
  return svg + "</svg>";
}

/// The middle of a picture in its own size; small ones whole, and enlarged.
std::string figure(const std::string& png, const std::string& caption, uint32_t width) {
  return "<figure><div class='crop" + std::string(width < 400 ? " small" : "") +
         "' style=\"background-image:url('data:image/png;base64," + absl::Base64Escape(png) +
         "')\"></div><figcaption>" + escaped(caption) + "</figcaption></figure>";
}

std::string recoveryTable(const std::vector<AccuracyPoint>& points) {
  std::string rows;
  for (const AccuracyPoint& p : points) {
    if (p.recovery.size() < 2) continue;
    rows += "<tr><td>" + escaped(p.name) + "</td>";
    for (size_t frame = 1; frame <= p.recovery.size(); frame *= 2)
      rows += "<td>" + shown(p.recovery[frame - 1]) + " &nbsp; " + fixed(p.ssim_along[frame - 1], 3) + "</td>";
    rows += "</tr>";
  }
  if (rows.empty()) return {};
  std::string head = "<tr><th>relative MSE and SSIM of frame</th>";
  for (size_t frame = 1; frame <= points.front().recovery.size(); frame *= 2)
    head += "<th>" + std::to_string(frame) + "</th>";
  return "<table>" + head + "</tr>" + rows + "</table>";
}

std::string section(const std::vector<AccuracyPoint>& points, const AccuracyReport& report) {
  std::string html = "<section><h2>" + escaped(points.front().axis) + "</h2><p>" + escaped(sentence(points)) +
                     "</p><table><tr><th></th><th>frame ms</th><th>p95</th><th>relative "
                     "MSE</th><th>bias</th><th>variance</th><th>SSIM</th><th>FLIP</th>"
                     "<th>flicker</th><th>memory MB</th><th>of it history MB</th></tr>";
  for (const AccuracyPoint& p : points) {
    html += "<tr><td>" + escaped(p.name) + "</td>";
    for (const std::string& cell :
         {fixed(p.frame_ms.median, 2), fixed(p.frame_ms.p95, 2), shown(p.error.total), shown(p.error.bias),
          shown(p.error.variance), fixed(p.ssim, 3), fixed(p.flip, 3),
          p.flicker ? fixed(*p.flicker, 4) : std::string("–"), megabytes(p.memory_bytes), megabytes(p.history_bytes)})
      html += "<td>" + cell + "</td>";
    html += "</tr>";
  }
  // The reference stays in sight beside all of them.
  html += "</table>" + recoveryTable(points) + "<div class=pictures><div style='grid-row: span " +
          std::to_string(points.size()) + "'>" + figure(report.reference_png, "reference", report.options.width) +
          "</div>";
  for (const AccuracyPoint& p : points)
    html += figure(p.picture_png, p.name, report.options.width) +
            figure(p.error_png, p.name + ": FLIP", report.options.width);
  return html + "</div></section>";
}

std::string passTable(const AccuracyReport& report) {
  std::string html = "<section><h2>Milliseconds by pass, median</h2><table>";
  for (const AccuracyPoint& p : report.points) {
    html += "<tr><td>" + escaped(p.axis + " " + p.name) + "</td><td style='text-align:left'>";
    for (const auto& [pass, ms] : p.passes)
      if (ms.median >= 0.01 * p.frame_ms.median) html += escaped(pass) + " " + shown(ms.median) + " &nbsp; ";
    html += "</td></tr>";
  }
  return html + "</table></section>";
}

}  // namespace

std::string toHtml(const AccuracyReport& report) {
  const AccuracyOptions& o = report.options;
  std::string html =
      "<!doctype html><html lang=en><meta charset=utf-8><title>What accuracy costs in time</title><style>" +
      std::string(kStyle) + "</style><h1>What accuracy costs in time</h1><p class=about>" +
      escaped(report.scene + ", camera " + report.camera) + ", " + std::to_string(o.width) + " × " +
      std::to_string(o.height) + ", the camera " +
      (o.motion == MotionKind::still ? "stands still"
       : o.motion == MotionKind::fly ? "flies past"
                                     : "has jumped") +
      ". Frame " + std::to_string(o.frames) + " of " + std::to_string(o.runs) + " runs, against " +
      grouped(o.reference_samples) + " samples of " + std::to_string(o.reference_bounces) +
      " bounces, whose own noise is a relative MSE of " + shown(report.reference_noise) + ".</p><p class=about>" +
      escaped(report.provenance.device.name + " (" + report.provenance.device.driver + "), " + report.provenance.date +
              ", " + report.provenance.build) +
      "<br><code>" + escaped(report.provenance.command) +
      "</code></p><p class=about><a download=accuracy.csv href='data:text/csv;base64," +
      absl::Base64Escape(toCsv(report)) + "'>All figures as CSV</a></p>" + paretoPlot(report);
  for (size_t i = 0; i < report.points.size();) {
    size_t end = i;
    while (end < report.points.size() && report.points[end].axis == report.points[i].axis) ++end;
    html += section({report.points.begin() + static_cast<std::ptrdiff_t>(i),
                     report.points.begin() + static_cast<std::ptrdiff_t>(end)},
                    report);
    i = end;
  }
  return html + passTable(report) + "</html>\n";
}

}  // namespace helio::bench
