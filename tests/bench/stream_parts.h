// The parts that `helio-bench stream` measures beside the whole path: a renderer whose pictures cost nothing, and the
// bare encoder and gRPC service, on threads that wait as those of the whole path do.
#pragma once

#include <heliograph/v1/viewer.grpc.pb.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "render/renderer.h"

namespace helio::bench {

namespace v1 = heliograph::v1;
using StreamClock = std::chrono::steady_clock;

/// A picture as a renderer might give: smooth gradients, hard edges and the noise of one path a pixel. RGBX.
std::vector<uint8_t> streamPicture(uint32_t width, uint32_t height);

/// Hands out one picture whenever it is told to, and notes when it did. In between its world's thread waits in tick(),
/// as it does for a GPU.
class FixedRenderer final : public render::Renderer {
 public:
  FixedRenderer(const uint8_t* rgbx, uint32_t width, uint32_t height)
      : pixels_(std::make_shared<render::Pixels>(render::Pixels{rgbx, width, height})) {}

  /// Lets one tick return: that which waits, or the next.
  void release();
  /// From now on no tick waits.
  void open();
  /// When tick() returned the picture of this tick.
  StreamClock::time_point rendered(uint64_t tick) const;

  render::DeviceInfo device() const override { return {"a fixed picture", "none", true}; }
  Result<render::WorldHandle> addWorld(scene::ScenePtr) override { return ++last_handle_; }
  void removeWorld(render::WorldHandle) override {}
  Result<render::ViewHandle> addView(render::WorldHandle) override { return ++last_handle_; }
  void removeView(render::ViewHandle) override {}
  Result<std::vector<render::Frame>> tick(render::WorldHandle world, const world::ChangeSet& changes,
                                          std::span<const render::ViewRequest> views) override;

 private:
  const std::shared_ptr<const render::Pixels> pixels_;
  std::atomic<uint64_t> last_handle_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  uint64_t released_ = 0;  ///< ticks that may return
  bool open_ = false;
  std::map<uint64_t, StreamClock::time_point> rendered_;
};

/// TurboJPEG's compressor as its manual shows it, with a buffer of its own, on a thread that sleeps between two
/// pictures.
class BareEncoder {
 public:
  BareEncoder(const std::vector<uint8_t>& rgbx, uint32_t width, uint32_t height, int quality);
  ~BareEncoder();
  BareEncoder(const BareEncoder&) = delete;
  BareEncoder& operator=(const BareEncoder&) = delete;

  /// Milliseconds of one compression, without the time that its thread takes to wake up.
  Result<double> once();
  /// What the last once() made.
  std::string jpeg() const { return {reinterpret_cast<const char*>(buffer_), size_}; }

 private:
  Result<double> encode();
  void work();

  const std::vector<uint8_t>& rgbx_;
  const uint32_t width_, height_;
  const int quality_;
  void* const compressor_;
  unsigned char* buffer_ = nullptr;
  unsigned long size_ = 0;

  std::mutex mutex_;
  std::condition_variable wake_, done_;
  bool asked_ = false, ending_ = false;
  std::optional<Result<double>> answer_;
  std::thread thread_;
};

/// Answers every message of a stream with the same frame: the callback API, on loopback, and nothing else.
class BareTransfer {
 public:
  explicit BareTransfer(const std::string& jpeg);
  ~BareTransfer();

  struct Transferred {
    double milliseconds;  ///< from the server's StartWrite to the end of the client's Read
    v1::ServerMessage message;
  };
  Result<Transferred> once();

 private:
  class Service;
  std::unique_ptr<Service> service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::ViewerService::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::ViewerMessage, v1::ServerMessage>> stream_;
};

}  // namespace helio::bench
