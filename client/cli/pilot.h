// Flies a tour: sends cameras and edits in real time while somebody else receives the frames.
#pragma once

#include <atomic>
#include <map>
#include <mutex>
#include <vector>

#include "cli/tour.h"
#include "lib/camera.h"
#include "lib/viewer_session.h"

namespace helio::cli {

/// Something that a frame will show.
struct Mark {
  std::string label;
  client::Clock::time_point sent;
  uint64_t camera_id = 0;  ///< seen from the frame with this camera on; or
  uint64_t seq = 0;        ///< seen from the frame with this edit on
};

/// run() on one thread; the rest from any.
class Pilot {
 public:
  /// Looks up every camera and prefab of the tour. Errors (not_found): a name that the world does not have.
  static Result<std::unique_ptr<Pilot>> prepare(client::Connection& connection, client::ViewerSession& session,
                                                const v1::World& world, Tour tour);

  /// Flies until the tour is over or stop() is called. Errors: an edit's.
  Result<void> run();
  void stop() { stopped_ = true; }

  std::vector<Mark> marks() const;
  /// The view that was sent under this camera id, while fewer than 10,000 newer ones were sent.
  std::optional<client::View> viewOf(uint64_t camera_id) const;
  /// Sends a view; returns its camera id.
  uint64_t look(const client::View& view, bool cut);

 private:
  Pilot(client::Connection& connection, client::ViewerSession& session, std::string world, Tour tour);

  Result<void> perform(const Jump& jump);
  Result<void> perform(const Fly& fly);
  Result<void> perform(const BuildStep& build);
  Result<void> perform(const DestroyStep& destroy);
  Result<void> perform(const SunStep& sun);
  Result<v1::ApplyEditsResponse> apply(v1::Edit edit);
  void mark(Mark mark);
  void waitUntil(client::Clock::time_point when);
  std::vector<const v1::Prefab*> prefabsFor(const std::string& name) const;
  glm::vec2 resolve(const Place& place) const;

  client::Connection& connection_;
  client::ViewerSession& session_;
  const std::string world_;
  Tour tour_;
  std::map<std::string, client::View> cameras_;
  std::vector<v1::Prefab> prefabs_;
  client::View here_;
  double step_seconds_ = 0;
  client::Clock::time_point sent_{};  ///< of the newest edit
  std::atomic<bool> stopped_ = false;
  mutable std::mutex mutex_;
  std::vector<Mark> marks_;
  std::map<uint64_t, client::View> views_;
};

}  // namespace helio::cli
