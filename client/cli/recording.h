// telemetry.json: what a viewing leaves beside its frames. README.md documents the format.
#pragma once

#include <string>
#include <vector>

#include "cli/pilot.h"

namespace helio::cli {

class Recording {
 public:
  explicit Recording(client::Clock::time_point start) : start_(start) {}

  struct Shown {
    std::string file;
    client::View view;
    client::Clock::time_point stored;
    double present_ms = 0;
    std::optional<double> motion_to_photon_ms;
  };
  void add(const v1::Frame& frame, const Shown& shown);

  size_t frames() const { return frames_.size(); }
  uint64_t dropped() const { return dropped_; }
  double framesPerSecond() const;

  /// Finds for each mark the first frame that shows it, and makes the document.
  Json document(const std::vector<Mark>& marks) const;

 private:
  struct Entry {
    Json json;
    uint64_t camera_id = 0, applied_seq = 0;
    client::Clock::time_point stored;
  };
  client::Clock::time_point start_;
  std::vector<Entry> frames_;
  std::vector<double> motion_to_photon_, gpu_;
  uint64_t dropped_ = 0, bytes_ = 0;
};

}  // namespace helio::cli
