#include "fake_renderer.h"

#include <thread>
#include <utility>

namespace helio::test {
namespace {

// Noise does not compress: frames from this width on are as large as frames can be.
constexpr uint32_t kNoiseFrom = 512;

struct Picture {
  render::Pixels pixels;
  std::vector<uint8_t> bytes;
  std::shared_ptr<std::atomic<int64_t>> live;
  ~Picture() { --*live; }
};

}  // namespace

Result<render::WorldHandle> FakeRenderer::addWorld(scene::ScenePtr) {
  std::lock_guard lock(mutex_);
  worlds_[next_] = false;
  return next_++;
}

void FakeRenderer::removeWorld(render::WorldHandle world) {
  std::lock_guard lock(mutex_);
  misuses_ += worlds_.erase(world) != 1;
}

Result<render::ViewHandle> FakeRenderer::addView(render::WorldHandle world) {
  std::lock_guard lock(mutex_);
  misuses_ += worlds_.count(world) != 1;
  views_[next_] = {world};
  return next_++;
}

void FakeRenderer::removeView(render::ViewHandle view) {
  std::lock_guard lock(mutex_);
  misuses_ += views_.erase(view) != 1;
}

size_t FakeRenderer::views() const {
  std::lock_guard lock(mutex_);
  return views_.size();
}

render::ViewSettings FakeRenderer::newestSettings() const {
  std::lock_guard lock(mutex_);
  return newest_settings_;
}

size_t FakeRenderer::worlds() const {
  std::lock_guard lock(mutex_);
  return worlds_.size();
}

Result<std::vector<render::Frame>> FakeRenderer::tick(render::WorldHandle world, const world::ChangeSet& changes,
                                                      std::span<const render::ViewRequest> views) {
  {
    std::lock_guard lock(mutex_);
    misuses_ += worlds_.count(world) != 1 || std::exchange(worlds_[world], true);
  }
  ++ticks_;
  slots_ += changes.slots.size();
  std::this_thread::sleep_for(std::chrono::milliseconds(tick_ms_));
  std::vector<render::Frame> frames;
  bool failed = false;
  for (const auto& request : views) {
    failed |= request.settings.width == fail_width_;
    auto picture = std::make_shared<Picture>();
    picture->live = live_;
    if (const int64_t now = ++*live_; now > *most_) *most_ = now;
    const auto& settings = request.settings;
    picture->bytes.resize(size_t{settings.width} * settings.height * 4);
    const uint8_t colour[4] = {uint8_t(changes.applied_seq * 16), uint8_t(request.view * 16),
                               uint8_t(request.camera.position.x), 255};
    uint32_t noise = 1;
    for (size_t i = 0; i < picture->bytes.size(); ++i)
      picture->bytes[i] =
          settings.width < kNoiseFrom ? colour[i % 4] : uint8_t((noise = noise * 1664525u + 1013904223u) >> 24);
    picture->pixels = {picture->bytes.data(), settings.width, settings.height};

    render::Frame frame;
    frame.pixels = std::shared_ptr<const render::Pixels>(picture, &picture->pixels);
    if (settings.keep_radiance) frame.radiance.assign(size_t{settings.width} * settings.height * 3, 0.5f);
    frame.stats.tick = changes.tick;
    frame.stats.applied_seq = changes.applied_seq;
    frame.stats.time = changes.time;
    frame.stats.gpu_ms = 1.5;
    frame.stats.passes = {{"paint", 1.5}};
    if (const double ms = ray_ms_ * settings.samples * (settings.bounces + 1); ms > 0.0) {
      frame.stats.passes.push_back({"path_trace", ms});
      frame.stats.gpu_ms += ms;
      if (settings.denoiser != render::Denoiser::none) frame.stats.variance = 0.01 / settings.samples;
    }
    frame.stats.effects = {{"paint", 7, 1024, 1.5}};
    frame.stats.nonfinite = 5;
    frame.stats.dropped = {{"paint", "NaN", 2}, {"paint", "negative", 3}};
    frame.stats.rays.primary = uint64_t{settings.width} * settings.height;
    {
      std::lock_guard lock(mutex_);
      misuses_ += views_.count(request.view) != 1;
      newest_settings_ = settings;
      frame.stats.accumulated = views_[request.view].accumulated += settings.samples;
    }
    frames.push_back(std::move(frame));
  }
  {
    std::lock_guard lock(mutex_);
    worlds_[world] = false;
  }
  if (lost_) return Error{ErrorKind::internal, "the device is lost", "device", {}, {}};
  if (failed) return Error{ErrorKind::limit, "out of GPU memory for a view of this size", "memory", {}, {}};
  return frames;
}

}  // namespace helio::test
