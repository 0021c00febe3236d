#include "cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace helio::cli {
namespace {

constexpr int kWidth = 30;
constexpr auto kRedraw = std::chrono::milliseconds(100);

}  // namespace

ProgressBar::ProgressBar(std::string title) : title_(std::move(title)), terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (terminal_ && drawn_) std::fputc('\n', stderr);
}

void ProgressBar::show(double fraction, const std::string& note) {
  fraction = std::clamp(fraction, 0.0, 1.0);
  if (!terminal_) {
    const int tenth = static_cast<int>(fraction * 10);
    if (tenth == std::exchange(last_tenth_, tenth)) return;
    std::fprintf(stderr, "%s %3.0f %% %s\n", title_.c_str(), fraction * 100, note.c_str());
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kRedraw && fraction < 1) return;
  last_ = now;
  drawn_ = true;
  const int full = static_cast<int>(fraction * kWidth);
  std::fprintf(stderr, "\r%s [%s%s] %3.0f %% %s\x1b[K", title_.c_str(), std::string(size_t(full), '#').c_str(),
               std::string(size_t(kWidth - full), '.').c_str(), fraction * 100, note.c_str());
}

Spinner::Spinner(std::string title) : title_(std::move(title)), terminal_(isatty(STDERR_FILENO) != 0) {}

Spinner::~Spinner() {
  if (terminal_ && turns_ > 0) std::fputs("\r\x1b[K", stderr);
}

void Spinner::turn() {
  if (terminal_) std::fprintf(stderr, "\r%s %c", title_.c_str(), "|/-\\"[turns_ % 4]);
  ++turns_;
}

}  // namespace helio::cli
