// The parts that `helio-bench stream` measures beside the whole path: a renderer whose pictures cost nothing, and a
// bare gRPC service that sends one message a request.
#pragma once

#include <heliograph/v1/viewer.grpc.pb.h>

#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "render/renderer.h"

namespace helio::bench {

namespace v1 = heliograph::v1;
using StreamClock = std::chrono::steady_clock;

/// A picture as a renderer might give: smooth gradients, hard edges and the noise of one path a pixel. RGBX.
std::vector<uint8_t> streamPicture(uint32_t width, uint32_t height);

/// Hands out one picture, at once, and notes when it did.
class FixedRenderer final : public render::Renderer {
 public:
  FixedRenderer(const uint8_t* rgbx, uint32_t width, uint32_t height)
      : pixels_(std::make_shared<render::Pixels>(render::Pixels{rgbx, width, height})) {}

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
  std::map<uint64_t, StreamClock::time_point> rendered_;
};

/// Answers every message of a stream with the same frame: the callback API, on loopback, and nothing else.
class BareTransfer {
 public:
  explicit BareTransfer(const std::string& jpeg);
  ~BareTransfer();

  /// Milliseconds from the server's StartWrite to the end of the client's Read.
  Result<double> once();

 private:
  class Service;
  std::unique_ptr<Service> service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::ViewerService::Stub> stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::ViewerMessage, v1::ServerMessage>> stream_;
};

}  // namespace helio::bench
