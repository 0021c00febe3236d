// Charts of series as SVG, for reports.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace helio::bench {

struct Series {
  std::string name;
  std::vector<std::pair<double, double>> points;  ///< x ascending
};

/// Lines over a common x, with a legend; y from 0.
struct Chart {
  std::string title;
  std::string x_label;
  std::vector<Series> series;
};

/// The charts one below the other, as one document.
std::string toSvg(const std::vector<Chart>& charts);

}  // namespace helio::bench
