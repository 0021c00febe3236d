#include "service/synthetic_renderer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace helio::service {
namespace {

// The code: seq, tick, camera, and a check of the three, lowest bits first, a block a bit, rows from the top.
constexpr uint32_t kBits = 4 * 32;

/// The grid of blocks of a picture: the largest blocks of which kBits fit in. Size 0: there are none.
struct Grid {
  uint32_t size = 0;  ///< of a block, pixels
  uint32_t columns = 0;

  Grid(uint32_t width, uint32_t height) {
    for (uint32_t s = std::min(width, height); s > 0 && size == 0; --s)
      if (uint64_t{width / s} * (height / s) >= kBits) size = s;
    if (size > 0) columns = width / size;
  }
};

/// A step of MurmurHash3.
uint32_t mix(uint32_t hash, uint32_t value) {
  value = std::rotl(value * 0xcc9e2d51u, 15) * 0x1b873593u;
  return std::rotl(hash ^ value, 13) * 5 + 0xe6546b64u;
}

uint32_t checkOf(const Painted& p) { return mix(mix(mix(1, p.seq), p.tick), p.camera); }

std::array<uint32_t, 4> wordsOf(const Painted& p) { return {p.seq, p.tick, p.camera, checkOf(p)}; }

bool bit(const std::array<uint32_t, 4>& words, uint32_t index) { return words[index / 32] >> index % 32 & 1; }

/// [0, 1] of a pixel: a block's bit, or grey where no block is.
std::vector<float> paint(const Painted& painted, uint32_t width, uint32_t height) {
  std::vector<float> grey(size_t{width} * height, 0.5f);
  const Grid grid(width, height);
  const auto words = wordsOf(painted);
  for (uint32_t index = 0; grid.size > 0 && index < kBits; ++index) {
    const uint32_t x = index % grid.columns * grid.size, y = index / grid.columns * grid.size;
    for (uint32_t row = y; row < y + grid.size; ++row)
      std::fill_n(grey.begin() + size_t{row} * width + x, grid.size, bit(words, index) ? 1.0f : 0.0f);
  }
  return grey;
}

struct Picture {
  std::vector<uint8_t> bytes;
  render::Pixels pixels;
};

class SyntheticRenderer final : public render::Renderer {
 public:
  explicit SyntheticRenderer(const SyntheticOptions& options) : options_(options) {}

  render::DeviceInfo device() const override { return {"synthetic", "none", true}; }

  Result<render::WorldHandle> addWorld(scene::ScenePtr) override {
    const std::lock_guard lock(mutex_);
    worlds_.insert(++last_handle_);
    return last_handle_;
  }
  void removeWorld(render::WorldHandle world) override {
    const std::lock_guard lock(mutex_);
    worlds_.erase(world);
  }
  Result<render::ViewHandle> addView(render::WorldHandle world) override {
    const std::lock_guard lock(mutex_);
    if (worlds_.count(world) == 0) return unknown("world", world);
    views_.insert(++last_handle_);
    return last_handle_;
  }
  void removeView(render::ViewHandle view) override {
    const std::lock_guard lock(mutex_);
    views_.erase(view);
  }

  Result<std::vector<render::Frame>> tick(render::WorldHandle world, const world::ChangeSet& changes,
                                          std::span<const render::ViewRequest> views) override {
    const auto done = std::chrono::steady_clock::now() + options_.frame_time;
    if (auto known = check(world, views); !known) return known.error();
    std::vector<render::Frame> frames;
    for (const render::ViewRequest& request : views) frames.push_back(render(request, changes));
    std::this_thread::sleep_until(done);
    return frames;
  }

 private:
  static Error unknown(const std::string& what, uint64_t handle) {
    return {
        ErrorKind::internal, "there is no " + what + " " + std::to_string(handle), what, std::to_string(handle), {}};
  }

  Result<void> check(render::WorldHandle world, std::span<const render::ViewRequest> views) {
    for (const render::ViewRequest& request : views) {
      if (auto good = render::check(request.camera); !good) return good;
      if (auto good = render::check(request.settings); !good) return good;
    }
    const std::lock_guard lock(mutex_);
    if (worlds_.count(world) == 0) return unknown("world", world);
    for (const render::ViewRequest& request : views)
      if (views_.count(request.view) == 0) return unknown("view", request.view);
    return {};
  }

  render::Frame render(const render::ViewRequest& request, const world::ChangeSet& changes) const {
    const uint32_t width = request.settings.width, height = request.settings.height;
    const Painted painted{static_cast<uint32_t>(changes.applied_seq), static_cast<uint32_t>(changes.tick),
                          cameraCode(request.camera.position)};
    const std::vector<float> grey = paint(painted, width, height);

    auto picture = std::make_shared<Picture>();
    picture->bytes.resize(grey.size() * 4);
    uint32_t random = checkOf(painted);
    for (size_t i = 0; i < grey.size(); ++i) {
      uint32_t level = static_cast<uint32_t>(grey[i] * 255.0f);
      if (options_.noise > 0) {
        random = random * 1664525u + 1013904223u;  // Numerical Recipes' generator
        const uint32_t shift = (random >> 16) % (options_.noise + 1);
        level = level < 128 ? level + shift : level - shift;
      }
      std::fill_n(&picture->bytes[i * 4], 3, static_cast<uint8_t>(level));
      picture->bytes[i * 4 + 3] = 255;
    }
    picture->pixels = {picture->bytes.data(), width, height};

    render::Frame frame;
    frame.pixels = std::shared_ptr<const render::Pixels>(picture, &picture->pixels);
    if (request.settings.keep_radiance)
      for (const float level : grey) frame.radiance.insert(frame.radiance.end(), 3, level);
    frame.stats.tick = changes.tick;
    frame.stats.applied_seq = changes.applied_seq;
    frame.stats.time = changes.time;
    frame.stats.gpu_ms = std::chrono::duration<double, std::milli>(options_.frame_time).count();
    frame.stats.passes = {{"paint", frame.stats.gpu_ms}};
    frame.stats.accumulated = request.settings.samples;
    return frame;
  }

  const SyntheticOptions options_;
  std::mutex mutex_;
  uint64_t last_handle_ = 0;
  std::set<render::WorldHandle> worlds_;
  std::set<render::ViewHandle> views_;
};

}  // namespace

uint32_t cameraCode(const glm::vec3& position) {
  uint32_t hash = 2;
  for (int i = 0; i < 3; ++i) hash = mix(hash, std::bit_cast<uint32_t>(position[i]));
  return hash;
}

std::optional<Painted> readPainted(const render::Pixels& pixels) {
  const Grid grid(pixels.width, pixels.height);
  if (grid.size == 0) return std::nullopt;
  std::array<uint32_t, 4> words{};
  for (uint32_t index = 0; index < kBits; ++index) {
    const uint32_t x = index % grid.columns * grid.size, y = index / grid.columns * grid.size;
    uint64_t sum = 0;
    for (uint32_t row = y; row < y + grid.size; ++row)
      for (uint32_t column = x; column < x + grid.size; ++column)
        sum += pixels.rgbx[(size_t{row} * pixels.width + column) * 4 + 1];  // green: most of the luminance
    if (sum >= uint64_t{128} * grid.size * grid.size) words[index / 32] |= 1u << index % 32;
  }
  const Painted painted{words[0], words[1], words[2]};
  if (words[3] != checkOf(painted)) return std::nullopt;
  return painted;
}

std::unique_ptr<render::Renderer> makeSyntheticRenderer(const SyntheticOptions& options) {
  return std::make_unique<SyntheticRenderer>(options);
}

}  // namespace helio::service
