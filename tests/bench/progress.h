// Progress of long work, on standard error: a bar on a terminal, one line where nobody looks on.
#pragma once

#include <cstddef>
#include <string>

namespace helio::bench {

/// The line is on show for as long as the object lives.
class Progress {
 public:
  /// `total` steps; 0: it is not known how many.
  explicit Progress(std::string label, size_t total = 0);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step();

 private:
  void draw() const;

  std::string label_;
  size_t total_;
  size_t done_ = 0;
  bool terminal_;
};

}  // namespace helio::bench
