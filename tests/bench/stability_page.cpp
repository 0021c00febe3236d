#include "bench/stability_page.h"

#include <absl/strings/escaping.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace helio::bench {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.45 system-ui, sans-serif; color: #1b2733; background: #f6f7f9; margin: 2rem auto; max-width: 68rem; padding: 0 1rem }
h1 { font-size: 1.6rem } h2 { font-size: 1.1rem; margin: 0 } code { font-size: .85em }
section { background: #fff; border: 1px solid #dde2e8; border-radius: 8px; padding: 1rem 1.2rem; margin: 1rem 0; display: grid; grid-template-columns: 19rem 1fr; gap: .4rem 1.5rem; break-inside: avoid }
section > header { grid-column: 1 / -1 } header p { margin: .1rem 0; color: #5b6774 }
table { border-collapse: collapse; font-variant-numeric: tabular-nums } td, th { padding: .15rem .5rem; text-align: right; font-weight: normal }
th { color: #5b6774; font-size: .85rem } td:first-child, th:first-child { text-align: left }
.overview { background: #fff; border: 1px solid #dde2e8; border-radius: 8px; width: 100% } .overview td { border-top: 1px solid #eef1f4 }
.bad { background: #c0392b; color: #fff; border-radius: 3px; padding: 0 .3rem } .good { color: #1e7d4f }
img { width: 5.4rem; height: 5.4rem; image-rendering: pixelated; border: 1px solid #dde2e8; display: block }
svg text { font-size: 10px; fill: #5b6774 } .grid { stroke: #e6eaee } .limit { stroke: #c0392b; stroke-dasharray: 4 3 }
)";
constexpr const char* kColours[] = {"#1f6fb2", "#d1811c", "#2f9266"};

constexpr double kWidth = 296, kHeight = 190, kLeft = 42, kRight = 8, kTop = 8, kBottom = 24;
constexpr double kLowest = -7, kHighest = 1;  // decades of the error axis
constexpr double kLimit = 0.01;

std::string difficulty(const StabilityCase& c, size_t i) {
  return c.variants ? "kind " + std::to_string(i)
         : i == 0   ? "1×"
                    : "10" + std::string(i > 1 ? "<sup>" + std::to_string(i) + "</sup>" : "") + "×";
}

std::string line(double x1, double y1, double x2, double y2, const std::string& kind) {
  char text[160];
  std::snprintf(text, sizeof text, "<line class='%s' x1='%.1f' y1='%.1f' x2='%.1f' y2='%.1f'/>", kind.c_str(), x1, y1,
                x2, y2);
  return text;
}

std::string label(double x, double y, const char* anchor, const std::string& words) {
  char text[64];
  std::snprintf(text, sizeof text, "<text x='%.1f' y='%.1f' text-anchor='%s'>", x, y, anchor);
  return text + words + "</text>";
}

/// Error against difficulty, both by decades: one line a way.
std::string plot(const StabilityCase& c) {
  const auto x = [&](size_t i) {
    return kLeft + (kWidth - kLeft - kRight) * (static_cast<double>(i) + 0.5) / static_cast<double>(c.points.size());
  };
  const auto y = [](double error) {
    const double decade = std::clamp(std::log10(std::max(error, 1e-30)), kLowest, kHighest);
    return kTop + (kHeight - kTop - kBottom) * (kHighest - decade) / (kHighest - kLowest);
  };
  std::string svg = "<svg width='" + shown(kWidth) + "' height='" + shown(kHeight) +
                    "' role='img' aria-label='error against difficulty'>";
  for (int decade = static_cast<int>(kLowest); decade <= static_cast<int>(kHighest); decade += 2) {
    const double at = y(std::pow(10.0, decade));
    svg +=
        line(kLeft, at, kWidth - kRight, at, "grid") + label(kLeft - 4, at + 3, "end", "1e" + std::to_string(decade));
  }
  svg += line(kLeft, y(kLimit), kWidth - kRight, y(kLimit), "limit");
  for (size_t i = 0; i < c.points.size(); ++i) svg += label(x(i), kHeight - 8, "middle", shown(c.points[i].value));
  for (size_t way = 0; way < c.points.front().results.size(); ++way) {
    std::string points, marks;
    for (size_t i = 0; i < c.points.size(); ++i) {
      const StabilityResult& result = c.points[i].results[way];
      char at[96];
      std::snprintf(at, sizeof at, "%.1f,%.1f ", x(i), y(result.badness()));
      points += at;
      std::snprintf(at, sizeof at, "<circle cx='%.1f' cy='%.1f' r='%s' fill='", x(i), y(result.badness()),
                    result.holds() ? "2.5" : "5");
      marks += at + std::string(result.holds() ? kColours[way % 3] : "#c0392b") + "'/>";
    }
    if (!c.variants)
      svg += "<polyline fill='none' stroke-width='1.5' stroke='" + std::string(kColours[way % 3]) + "' points='" +
             points + "'/>";
    svg += marks;
  }
  return svg + "</svg>";
}

std::string pictures(const StabilityCase& c) {
  std::string html = "<table><tr><th></th>";
  for (const StabilityPoint& point : c.points) html += "<th>" + shown(point.value) + "</th>";
  html += "</tr>";
  for (size_t way = 0; way < c.points.front().results.size(); ++way) {
    html += "<tr><td style='color:" + std::string(kColours[way % 3]) + "'>" +
            escaped(c.points.front().results[way].way) + "</td>";
    for (const StabilityPoint& point : c.points)
      html += "<td><img alt='' src='data:image/png;base64," + absl::Base64Escape(point.results[way].png) + "'></td>";
    html += "</tr>";
  }
  return html + "</table>";
}

std::string section(const StabilityCase& c) {
  std::string html =
      "<section id='" + c.name + "'><header><h2>" + escaped(c.name) + "</h2><p>" + escaped(c.parameter) + "</p>";
  for (const StabilityPoint& point : c.points)
    for (const StabilityResult& result : point.results)
      for (const std::string& what : result.broken)
        html += "<p><span class='bad'>" + shown(point.value) + ", " + escaped(result.way) + "</span> " + escaped(what) +
                "</p>";
  return html + "</header>" + plot(c) + "<div>" + pictures(c) + "</div></section>";
}

/// The worst of a point's ways.
std::string cell(const StabilityPoint& point) {
  const auto worst = std::max_element(point.results.begin(), point.results.end(), [](const auto& a, const auto& b) {
    return std::pair(!a.holds(), a.badness()) < std::pair(!b.holds(), b.badness());
  });
  return std::string("<td><span class='") + (worst->holds() ? "good" : "bad") + "'>" + shown(worst->badness()) +
         "</span></td>";
}

std::string overview(const std::vector<StabilityCase>& cases) {
  size_t columns = 0;
  for (const StabilityCase& c : cases) columns = std::max(columns, c.points.size());
  std::string html = "<table class='overview'><tr><th>case</th>";
  StabilityCase graded;
  for (size_t i = 0; i < columns; ++i) html += "<th>" + difficulty(graded, i) + "</th>";
  html += "<th>not finite</th></tr>";
  for (const StabilityCase& c : cases) {
    uint64_t nonfinite = 0;
    html += "<tr><td><a href='#" + c.name + "'>" + escaped(c.name) + "</a></td>";
    for (size_t i = 0; i < columns; ++i) html += i < c.points.size() ? cell(c.points[i]) : "<td></td>";
    for (const StabilityPoint& point : c.points)
      for (const StabilityResult& result : point.results) nonfinite += result.nonfinite_samples + result.broken_texels;
    html += "<td>" + std::to_string(nonfinite) + "</td></tr>";
  }
  return html + "</table>";
}

}  // namespace

bool StabilityCase::holds() const {
  return std::all_of(points.begin(), points.end(), [](const StabilityPoint& point) {
    return std::all_of(point.results.begin(), point.results.end(), [](const auto& result) { return result.holds(); });
  });
}

std::string stabilityPage(const Provenance& origin, const std::vector<StabilityCase>& cases) {
  const auto held = std::count_if(cases.begin(), cases.end(), [](const StabilityCase& c) { return c.holds(); });
  std::string html =
      "<!doctype html><html lang='en'><meta charset='utf-8'><title>Hard cases</title><style>" + std::string(kStyle) +
      "</style><h1>Hard cases</h1><p>" + std::to_string(held) + " of " + std::to_string(cases.size()) +
      " cases hold. " + escaped(origin.device.name) + ", " + origin.date + "<br><code>" + escaped(origin.command) +
      "</code></p><p>The table and the plots show the error of the mean against the truth, relative; where the truth "
      "is not known, how unlike the picture is to its twin's (1 − SSIM), or the energy gained. The dashed line is 1 %. "
      "Pictures: reference, hybrid with traced and with rasterised primary hits, from the easiest to the hardest.</p>" +
      overview(cases);
  for (const StabilityCase& c : cases) html += section(c);
  return html + "</html>\n";
}

}  // namespace helio::bench
