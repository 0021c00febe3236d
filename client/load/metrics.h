// What is measured, by name: scenarios, reports and the page say these words.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace helio::load {

/// Series of times in milliseconds, a value an event.
enum Series : size_t {
  kAttach,         ///< from the intended start to the welcome
  kFirstFrame,     ///< ... to the first frame
  kReattach,       ///< from the intended reconnection to the next frame
  kFrameInterval,  ///< between two frames shown
  kMotionToPhoton,
  kJump,  ///< from a jump's intended time until a frame is shown that has its camera and every edit acknowledged before
  kJumpComplete,   ///< ... until the first such frame that lacks nothing: its telemetry says that no BLAS waits for a
                   ///< tick
  kEdit,           ///< from the intended time to the acknowledgement
  kEditToPicture,  ///< from the intended time to the first frame shown that has it
  kGpu,
  kCameraWait,
  kTick,
  kMailbox,
  kEncode,
  kQueue,
  kPreviousWrite,
  kSeriesCount
};

constexpr std::array<const char*, kSeriesCount> kSeriesNames = {
    "attach_ms",           "first_frame_ms", "reattach_ms",      "frame_interval_ms",
    "motion_to_photon_ms", "jump_ms",        "jump_complete_ms", "edit_ms",
    "edit_to_picture_ms",  "gpu_ms",         "camera_wait_ms",   "tick_ms",
    "mailbox_ms",          "encode_ms",      "queue_ms",         "previous_write_ms"};

/// The stages of a frame on the server, in order.
constexpr std::array<Series, 6> kStages = {kCameraWait, kTick, kMailbox, kEncode, kQueue, kPreviousWrite};

/// One value a client (frames_per_second, kilobits_per_second), or a sample of the server every half second.
constexpr std::array<const char*, 3> kSpreadNames = {"frames_per_second", "kilobits_per_second", "server_memory_mib"};

/// One number a run. Those in the second list know no group.
constexpr std::array<const char*, 7> kGroupCountNames = {
    "frames", "dropped_frames", "steps", "failed_steps", "ended_streams", "wrong_pictures", "acknowledged_edits"};
constexpr std::array<const char*, 3> kRunCountNames = {"lost_edits", "doubled_edits", "server_memory_drift_percent"};

constexpr std::array<const char*, 7> kStatisticNames = {"min", "mean", "p50", "p95", "p99", "p99.9", "max"};

std::optional<Series> seriesOf(const std::string& name);
/// Whether a metric is many values, of which a statistic is taken.
bool hasStatistic(const std::string& metric);
bool knowsGroups(const std::string& metric);
bool isMetric(const std::string& name);

/// Percentiles are nearest rank: always a value that was measured. None: nothing was measured.
std::optional<double> statistic(const std::vector<double>& sorted, const std::string& name);

}  // namespace helio::load
