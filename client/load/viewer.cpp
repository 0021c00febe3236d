#include "load/viewer.h"

#include <algorithm>
#include <utility>

#include "service/synthetic_renderer.h"

namespace helio::load {
namespace {

constexpr size_t kSeqsKept = 4096;  // an acknowledgement is not that much later than the picture

bool lacksNothing(const v1::AccelerationUse& use) {
  return use.own_blases_waiting() == 0 && use.shared_blases_waiting() == 0 && use.culling().left_over() == 0 &&
         use.culling().unshown() == 0;
}

}  // namespace

Result<void> Viewer::attach(client::Connection& connection, const client::View& view, Clock::time_point intended,
                            Series first) {
  close();
  client::ViewerSession::Options options;
  options.world = options_.world;
  options.settings = options_.settings;
  options.camera = client::toWire(view);
  auto session = client::ViewerSession::attach(connection, options);
  if (!session) return session.error();
  record_.took(kAttach, intended);
  const std::lock_guard lock(mutex_);
  session_ = std::move(*session);
  open_ = reading_ = true;
  end_expected_ = false;
  looked_.clear();
  positions_.clear();
  last_camera_ = 0;
  noteCamera(view, intended);
  jumped_.clear();
  edited_.clear();
  applied_.clear();
  awaits_first_ = {first, intended};
  last_shown_.reset();
  reader_ = std::thread([this] { read(); });
  return {};
}

bool Viewer::attached() const {
  const std::lock_guard lock(mutex_);
  return open_;
}

std::string Viewer::lastWords() const {
  const std::lock_guard lock(mutex_);
  return last_words_;
}

void Viewer::expectEnd() {
  const std::lock_guard lock(mutex_);
  end_expected_ = true;
}

void Viewer::cancel() {
  const std::lock_guard lock(mutex_);
  end_expected_ = true;
  reading_ = true;
  changed_.notify_all();
  if (session_) session_->cancel();
}

void Viewer::close() {
  if (!reader_.joinable()) return;
  cancel();
  reader_.join();
  const std::lock_guard lock(mutex_);
  session_.reset();
}

void Viewer::look(const client::View& view, bool cut, Clock::time_point intended) {
  {
    const std::lock_guard lock(mutex_);  // noted first: the frame may be here before look() returns
    noteCamera(view, intended);
  }
  send(view, cut);
}

void Viewer::jump(const client::View& view, Clock::time_point intended) {
  {
    const std::lock_guard lock(mutex_);
    noteCamera(view, intended);
    jumped_.push_back({last_camera_, newest_seq_, intended, false});
  }
  send(view, true);
}

void Viewer::noteCamera(const client::View& view, Clock::time_point intended) {
  ++last_camera_;  // as the session counts
  looked_.push_back({last_camera_, intended});
  positions_[last_camera_] = view.position;
}

void Viewer::send(const client::View& view, bool cut) {
  auto camera = client::toWire(view);
  camera.set_cut(cut);
  session_->look(std::move(camera));
}

void Viewer::edited(uint64_t seq, Clock::time_point intended) {
  const std::lock_guard lock(mutex_);
  newest_seq_ = std::max(newest_seq_, seq);
  if (!open_) return;
  // Acknowledgements and frames are different streams: the picture may have been first.
  const auto shown =
      std::find_if(applied_.begin(), applied_.end(), [&](const auto& entry) { return entry.first >= seq; });
  if (shown == applied_.end()) edited_[seq] = intended;
  else record_.add(kEditToPicture, shown->second, secondsBetween(intended, shown->second) * 1000);
}

void Viewer::setReading(bool reading) {
  const std::lock_guard lock(mutex_);
  reading_ = reading;
  changed_.notify_all();
}

void Viewer::read() {
  std::optional<Clock::time_point> since;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return reading_; });
    }
    auto received = session_->next();
    if (!received || !*received) {
      const std::lock_guard lock(mutex_);
      open_ = false;
      last_words_ = received ? "it was left" : received.error().message;
      if (!end_expected_) record_.streamEnded(last_words_);
      break;
    }
    if (options_.check_pictures) check((*received)->frame);
    session_->shown(**received, Clock::now());
    const auto now = Clock::now();
    if (!since) since = now;
    shown((*received)->frame, now);
  }
  if (since) record_.watched(std::max(0.0, secondsBetween(std::max(*since, options_.measured_from), Clock::now())));
}

void Viewer::shown(const v1::Frame& frame, Clock::time_point now) {
  const auto since = [&](Clock::time_point then) { return secondsBetween(then, now) * 1000; };
  record_.frame(now, frame.data().size(), frame.telemetry().dropped_before());
  noteStages(frame, now);
  const std::lock_guard lock(mutex_);
  if (const auto first = std::exchange(awaits_first_, std::nullopt))
    record_.add(first->first, now, since(first->second));
  if (last_shown_) record_.add(kFrameInterval, now, since(*last_shown_));
  last_shown_ = now;

  // Cameras that were never shown had a newer one before their tick.
  while (!looked_.empty() && looked_.front().id <= frame.camera_id()) {
    if (looked_.front().id == frame.camera_id()) record_.add(kMotionToPhoton, now, since(looked_.front().intended));
    looked_.pop_front();
  }
  positions_.erase(positions_.begin(), positions_.lower_bound(frame.camera_id()));
  noteJumps(frame, now);
  while (!edited_.empty() && edited_.begin()->first <= frame.applied_seq()) {
    record_.add(kEditToPicture, now, since(edited_.begin()->second));
    edited_.erase(edited_.begin());
  }
  if (applied_.empty() || applied_.back().first < frame.applied_seq()) applied_.emplace_back(frame.applied_seq(), now);
  if (applied_.size() > kSeqsKept) applied_.pop_front();
}

void Viewer::noteJumps(const v1::Frame& frame, Clock::time_point now) {
  const bool complete = lacksNothing(frame.telemetry().acceleration());
  const auto later = std::find_if(jumped_.begin(), jumped_.end(), [&](const Jumped& jump) {
    return jump.camera > frame.camera_id() || jump.seq > frame.applied_seq();
  });
  for (auto jump = jumped_.begin(); jump != later; ++jump) {
    const double ms = secondsBetween(jump->intended, now) * 1000;
    if (!std::exchange(jump->shown, true)) record_.add(kJump, now, ms);
    if (complete) record_.add(kJumpComplete, now, ms);
  }
  if (complete) jumped_.erase(jumped_.begin(), later);
}

void Viewer::noteStages(const v1::Frame& frame, Clock::time_point now) {
  const auto& stages = frame.telemetry().stages();
  const std::pair<Series, uint32_t> times[] = {{kCameraWait, stages.camera_wait_us()},
                                               {kTick, stages.tick_us()},
                                               {kMailbox, stages.mailbox_us()},
                                               {kEncode, stages.encode_us()},
                                               {kQueue, stages.queue_us()},
                                               {kPreviousWrite, stages.previous_write_us()}};
  for (const auto& [series, us] : times) record_.add(series, now, us / 1000.0);
  record_.add(kGpu, now, double(frame.telemetry().gpu_ms()));
}

/// The synthetic renderer paints what a picture shows: it must be what the frame says, and this viewer's camera.
void Viewer::check(const v1::Frame& frame) {
  const auto wrong = [&](const std::string& what) {
    record_.wrongPicture("frame " + std::to_string(frame.id()) + " " + what);
  };
  if (auto decoded = decoder_.decode(frame.data(), image_); !decoded) return wrong(decoded.error().message);
  const auto painted = service::readPainted({image_.rgbx.data(), image_.width, image_.height});
  if (!painted) return wrong("is none of the synthetic renderer's");
  if (painted->seq != static_cast<uint32_t>(frame.applied_seq()) ||
      painted->tick != static_cast<uint32_t>(frame.tick()))
    return wrong("shows another tick or sequence number than it says");
  const std::lock_guard lock(mutex_);
  const auto position = positions_.find(frame.camera_id());
  if (position == positions_.end() || service::cameraCode(position->second) != painted->camera)
    wrong("shows another camera than it says");
}

}  // namespace helio::load
