// A renderer that paints what it was asked for, so that the tests measure the service and not the GPU.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

#include "render/renderer.h"

namespace helio::test {

/// Every pixel of a frame has the colour (applied_seq * 16, view * 16, position.x) mod 256 of its request; frames 512
/// pixels wide and more are noise.
class FakeRenderer final : public render::Renderer {
 public:
  render::DeviceInfo device() const override { return {"painter", "1.0", true}; }
  Result<render::WorldHandle> addWorld(scene::ScenePtr scene) override;
  void removeWorld(render::WorldHandle world) override;
  Result<render::ViewHandle> addView(render::WorldHandle world) override;
  void removeView(render::ViewHandle view) override;
  Result<std::vector<render::Frame>> tick(render::WorldHandle world, const world::ChangeSet& changes,
                                          std::span<const render::ViewRequest> views) override;

  /// How long a tick takes.
  void setTickTime(std::chrono::milliseconds time) { tick_ms_ = int(time.count()); }
  /// Ticks with a view of this width fail with ErrorKind::limit, as when memory runs out.
  void failWidth(uint32_t width) { fail_width_ = width; }

  /// Of a path's every ray, so that time grows with samples and bounces; what it knows of variance falls with samples.
  void setCostOfPaths(double ms_a_ray) { ray_ms_ = ms_a_ray; }

  /// Every tick from now on fails as on a device that is lost.
  void loseDevice() { lost_ = true; }

  size_t views() const;
  size_t worlds() const;
  /// Pictures that somebody still holds, now and at most.
  int64_t livePixels() const { return *live_; }
  int64_t mostPixels() const { return *most_; }
  uint64_t ticks() const { return ticks_; }
  /// Of the last view of the last tick.
  render::ViewSettings newestSettings() const;
  /// Slots that change sets have held, in all.
  uint64_t slots() const { return slots_; }
  /// Misuse that a real renderer would not survive: one world from two threads, unknown handles.
  uint64_t misuses() const { return misuses_; }

 private:
  struct View {
    render::WorldHandle world;
    uint32_t accumulated = 0;
  };
  mutable std::mutex mutex_;
  std::map<render::WorldHandle, bool> worlds_;  ///< in a tick
  std::map<render::ViewHandle, View> views_;
  render::ViewSettings newest_settings_;
  uint64_t next_ = 1;
  std::atomic<int> tick_ms_ = 1;
  std::atomic<uint32_t> fail_width_ = 0;
  std::atomic<double> ray_ms_ = 0.0;
  std::atomic<bool> lost_ = false;
  std::atomic<uint64_t> ticks_ = 0, slots_ = 0, misuses_ = 0;
  // Shared with the frames, which may outlive the renderer.
  std::shared_ptr<std::atomic<int64_t>> live_ = std::make_shared<std::atomic<int64_t>>(0);
  std::shared_ptr<std::atomic<int64_t>> most_ = std::make_shared<std::atomic<int64_t>>(0);
};

}  // namespace helio::test
