// One viewer of a load test: reads frames on a thread of its own, acknowledges them, and notes how long everything took
// to become visible.
#pragma once

#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "lib/camera.h"
#include "lib/jpeg_decoder.h"
#include "lib/viewer_session.h"
#include "load/record.h"

namespace helio::load {

namespace v1 = heliograph::v1;

/// One thread calls it; cancel() any. Times are from when something was meant to happen: a client that is late does not
/// flatter the server (no coordinated omission).
class Viewer {
 public:
  struct Options {
    std::string world;
    v1::Settings settings;
    bool check_pictures = false;
    Clock::time_point measured_from;  ///< the end of the warm-up
  };
  Viewer(Record& record, Options options) : record_(record), options_(std::move(options)) {}
  ~Viewer() { close(); }

  /// `first` is the series of the first frame's time.
  Result<void> attach(client::Connection& connection, const client::View& view, Clock::time_point intended,
                      Series first);
  bool attached() const;
  /// Why the stream ended that was not closed here.
  std::string lastWords() const;
  /// Ends the stream. `expected`: whatever ends it from now on is no mishap.
  void close();
  void expectEnd();
  void cancel();

  void look(const client::View& view, bool cut, Clock::time_point intended);
  /// As look(), and waits in the record for the first frame that shows it, and for the first that is complete.
  void jump(const client::View& view, Clock::time_point intended);
  /// An edit was acknowledged: waits for the first frame that shows it.
  void edited(uint64_t seq, Clock::time_point intended);
  void setReading(bool reading);

 private:
  struct Looked {
    uint64_t id;
    Clock::time_point intended;
  };
  struct Jumped {
    uint64_t camera, seq;
    Clock::time_point intended;
    bool shown = false;  ///< but not complete
  };

  void noteCamera(const client::View& view, Clock::time_point intended);  ///< with mutex_ held
  void send(const client::View& view, bool cut);
  void read();
  void shown(const v1::Frame& frame, Clock::time_point now);
  void noteJumps(const v1::Frame& frame, Clock::time_point now);  ///< with mutex_ held
  void noteStages(const v1::Frame& frame, Clock::time_point now);
  void check(const v1::Frame& frame);

  Record& record_;
  const Options options_;
  std::unique_ptr<client::ViewerSession> session_;
  std::thread reader_;
  client::JpegDecoder decoder_;
  client::JpegDecoder::Image image_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool reading_ = true, open_ = false, end_expected_ = false;
  std::string last_words_;
  uint64_t last_camera_ = 0;
  std::deque<Looked> looked_;  ///< cameras that no frame has shown
  std::map<uint64_t, glm::vec3> positions_;
  std::deque<Jumped> jumped_;                                   ///< that no complete frame has shown
  std::map<uint64_t, Clock::time_point> edited_;                ///< by sequence number
  std::deque<std::pair<uint64_t, Clock::time_point>> applied_;  ///< when each sequence number was first shown
  uint64_t newest_seq_ = 0;                                     ///< acknowledged to this client
  std::optional<std::pair<Series, Clock::time_point>> awaits_first_;
  std::optional<Clock::time_point> last_shown_;
};

}  // namespace helio::load
