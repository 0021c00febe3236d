#include "bench/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace helio::bench {

Progress::Progress(std::string label, size_t total)
    : label_(std::move(label)), total_(total), terminal_(isatty(STDERR_FILENO) == 1) {
  if (terminal_) draw();
  else std::fprintf(stderr, "%s\n", label_.c_str());
}

Progress::~Progress() {
  if (terminal_) std::fputs("\r\033[K", stderr);
}

void Progress::step() {
  ++done_;
  if (terminal_) draw();
}

void Progress::draw() const {
  constexpr size_t kWidth = 30;
  std::string bar;
  if (total_ > 0) {
    const size_t filled = kWidth * done_ / total_;
    bar = "[" + std::string(filled, '#') + std::string(kWidth - filled, '.') + "] " + std::to_string(done_) + "/" +
          std::to_string(total_) + " ";
  }
  std::fprintf(stderr, "\r%s%s\033[K", bar.c_str(), label_.c_str());
  std::fflush(stderr);
}

}  // namespace helio::bench
