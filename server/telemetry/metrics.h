// What an operator watches: Prometheus metrics of the whole server, without names of worlds or users.
#pragma once

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <string>

namespace helio::telemetry {

/// Base units (seconds, bytes), prefix heliograph_. Thread-safe; counting costs an atomic addition.
class Metrics {
 private:
  prometheus::Registry registry_;
  prometheus::Gauge& gauge(const char* name, const char* help);
  prometheus::Counter& counter(const char* name, const char* help);
  prometheus::Histogram& seconds(const char* name, const char* help);

 public:
  explicit Metrics(const std::string& version);

  // Counted where it happens.
  prometheus::Counter& frames = counter("heliograph_frames_total", "Frames sent to viewers.");
  prometheus::Counter& frame_bytes = counter("heliograph_frame_bytes_total", "Bytes of their compressed pictures.");
  prometheus::Counter& frames_dropped =
      counter("heliograph_frames_dropped_total", "Frames rendered and replaced by newer ones before they were sent.");
  prometheus::Counter& edits = counter("heliograph_edits_total", "Edits and placements acknowledged.");
  prometheus::Counter& rate_limited =
      counter("heliograph_edits_refused_total", "Calls refused by max-edits-per-second.");
  prometheus::Counter& ghosts =
      counter("heliograph_viewers_timed_out_total", "Viewers ended because they fell silent.");
  prometheus::Counter& resumed =
      counter("heliograph_viewers_resumed_total", "Viewers that came back to their history.");
  prometheus::Histogram& tick =
      seconds("heliograph_tick_seconds", "A world's tick, from commands to pixels on the host.");
  prometheus::Histogram& encode = seconds("heliograph_encode_seconds", "Compressing one frame.");
  prometheus::Histogram& edit_to_picture =
      seconds("heliograph_edit_to_picture_seconds", "An edit's arrival to the write of the first frame that shows it.");
  prometheus::Histogram& round_trip =
      seconds("heliograph_round_trip_seconds", "A frame's write to its acknowledgement, without the client's time.");

  // Set before they are read.
  prometheus::Gauge& ready = gauge("heliograph_ready", "1 while new clients are welcome.");
  prometheus::Gauge& viewers = gauge("heliograph_viewers", "Viewers and running shots.");
  prometheus::Gauge& instances = gauge("heliograph_instances", "Instances in all worlds that are ready.");
  prometheus::Gauge& resident = gauge("heliograph_resident_memory_bytes", "Resident memory of the server process.");
  prometheus::Gauge& uptime = gauge("heliograph_uptime_seconds", "Since the server started.");

  /// `state`: loading, ready, failed.
  void setWorlds(const std::string& state, double count);
  /// A call has ended. `method`: one of ours, or "other"; `code`: "OK", "UNAVAILABLE", ...
  void called(const std::string& method, const std::string& code);

  /// All of them, in the text format of Prometheus.
  std::string text() const;

 private:
  prometheus::Family<prometheus::Gauge>& worlds_;
  prometheus::Family<prometheus::Counter>& calls_;
};

}  // namespace helio::telemetry
