#include "bench/plot.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <cmath>

namespace helio::bench {
namespace {

constexpr double kLeft = 60.0, kWidth = 620.0, kTop = 34.0, kHeight = 170.0, kChart = 250.0;
constexpr const char* kColors[] = {"#35618f", "#c8752d", "#5b8c4a", "#8a4f7d", "#b03a48", "#6b6b6b"};

/// The next of 1, 2, 5, 10, ... above.
double niceAbove(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(std::max(value, 1e-12))));
  for (const double step : {1.0, 2.0, 5.0})
    if (value <= step * decade) return step * decade;
  return 10.0 * decade;
}

std::string draw(const Chart& chart, double top) {
  double first = 1e300, last = -1e300, most = 0.0;
  for (const Series& series : chart.series)
    for (const auto& [x, y] : series.points) {
      first = std::min(first, x);
      last = std::max(last, x);
      most = std::max(most, y);
    }
  if (first > last) first = last = 0.0;
  const double ceiling = niceAbove(most), span = std::max(last - first, 1e-12);
  const auto px = [&](double x) { return kLeft + kWidth * (x - first) / span; };
  const auto py = [&](double y) { return top + kTop + kHeight * (1.0 - y / ceiling); };
  std::string svg = fmt::format("<text x='10' y='{:.0f}' font-weight='bold'>{}</text>\n", top + 14.0, chart.title);
  for (int i = 0; i <= 4; ++i) {
    const double y = ceiling * i / 4.0;
    svg += fmt::format(
        "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' "
        "text-anchor='end'>{5:g}</text>\n",
        kLeft, kLeft + kWidth, py(y), kLeft - 6.0, py(y) + 4.0, y);
    const double x = first + span * i / 4.0;
    svg += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{:g}</text>\n", px(x),
                       top + kTop + kHeight + 15.0, x);
  }
  svg += fmt::format("<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{}</text>\n", kLeft + kWidth / 2.0,
                     top + kTop + kHeight + 30.0, chart.x_label);
  double legend = kLeft;
  for (size_t i = 0; i < chart.series.size(); ++i) {
    const Series& series = chart.series[i];
    const char* color = kColors[i % std::size(kColors)];
    svg += fmt::format(
        "<rect x='{0:.0f}' y='{1:.0f}' width='9' height='9' fill='{2}'/><text x='{3:.0f}' y='{4:.0f}'>{5}</text>\n",
        legend, top + 20.0, color, legend + 13.0, top + 28.0, series.name);
    legend += 30.0 + 6.5 * static_cast<double>(series.name.size());
    svg += fmt::format("<polyline fill='none' stroke='{}' stroke-width='1.5' points='", color);
    for (const auto& [x, y] : series.points) svg += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
    svg += "'/>\n";
  }
  return svg;
}

}  // namespace

std::string toSvg(const std::vector<Chart>& charts) {
  const double height = kChart * static_cast<double>(charts.size());
  std::string svg = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' width='720' height='{0:.0f}' font-family='sans-serif' "
      "font-size='11'>\n<rect width='720' height='{0:.0f}' fill='white'/>\n",
      height);
  for (size_t i = 0; i < charts.size(); ++i) svg += draw(charts[i], kChart * static_cast<double>(i));
  return svg + "</svg>\n";
}

}  // namespace helio::bench
