// Progress on standard error: a bar that redraws itself on a terminal, a few lines elsewhere.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace helio::cli {

class ProgressBar {
 public:
  explicit ProgressBar(std::string title);
  /// Ends the line.
  ~ProgressBar();
  /// `fraction` is [0, 1]; `note` stands behind the bar.
  void show(double fraction, const std::string& note);

 private:
  std::string title_;
  bool terminal_;
  bool drawn_ = false;
  int last_tenth_ = -1;
  std::chrono::steady_clock::time_point last_{};
};

/// For work of unknown length.
class Spinner {
 public:
  explicit Spinner(std::string title);
  ~Spinner();
  void turn();

 private:
  std::string title_;
  bool terminal_;
  unsigned turns_ = 0;
};

}  // namespace helio::cli
