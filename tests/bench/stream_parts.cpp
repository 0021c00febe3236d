#include "bench/stream_parts.h"

#include <grpcpp/grpcpp.h>
#include <turbojpeg.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace helio::bench {
namespace {

double millisecondsSince(StreamClock::time_point start) {
  return std::chrono::duration<double, std::milli>(StreamClock::now() - start).count();
}

}  // namespace

std::vector<uint8_t> streamPicture(uint32_t width, uint32_t height) {
  constexpr uint32_t kNoise = 24;  // levels
  constexpr uint32_t kTile = 48;   // pixels
  std::vector<uint8_t> rgbx(size_t{width} * height * 4);
  uint32_t random = 1;
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const uint32_t tile = (x / kTile * 7 + y / kTile * 13) % 5;
      const double light = 0.55 + 0.35 * std::sin(0.011 * x) * std::cos(0.017 * y);
      for (uint32_t channel = 0; channel < 3; ++channel) {
        random = random * 1664525u + 1013904223u;  // Numerical Recipes' generator
        const double level = light * (90 + 30 * ((tile + channel) % 5)) + (random >> 16) % kNoise;
        rgbx[(size_t{y} * width + x) * 4 + channel] = static_cast<uint8_t>(std::clamp(level, 0.0, 255.0));
      }
    }
  return rgbx;
}

// ---- FixedRenderer

void FixedRenderer::release() {
  const std::lock_guard lock(mutex_);
  ++released_;
  wake_.notify_one();
}

void FixedRenderer::open() {
  const std::lock_guard lock(mutex_);
  open_ = true;
  wake_.notify_all();
}

StreamClock::time_point FixedRenderer::rendered(uint64_t tick) const {
  const std::lock_guard lock(mutex_);
  return rendered_.at(tick);
}

Result<std::vector<render::Frame>> FixedRenderer::tick(render::WorldHandle, const world::ChangeSet& changes,
                                                       std::span<const render::ViewRequest> views) {
  std::vector<render::Frame> frames(views.size());
  for (auto& frame : frames) {
    frame.pixels = pixels_;
    frame.stats.tick = changes.tick;
    frame.stats.applied_seq = changes.applied_seq;
  }
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [&] { return open_ || released_ > 0; });
  if (!open_) --released_;
  rendered_[changes.tick] = StreamClock::now();
  return frames;
}

// ---- BareEncoder

BareEncoder::BareEncoder(const std::vector<uint8_t>& rgbx, uint32_t width, uint32_t height, int quality)
    : rgbx_(rgbx), width_(width), height_(height), quality_(quality), compressor_(tjInitCompress()), thread_([this] {
        work();
      }) {}

BareEncoder::~BareEncoder() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    wake_.notify_one();
  }
  thread_.join();
  tjFree(buffer_);
  tjDestroy(compressor_);
}

Result<double> BareEncoder::once() {
  std::unique_lock lock(mutex_);
  asked_ = true;
  wake_.notify_one();
  done_.wait(lock, [&] { return answer_.has_value(); });
  return *std::exchange(answer_, std::nullopt);
}

Result<double> BareEncoder::encode() {
  const auto start = StreamClock::now();
  if (!compressor_ || tjCompress2(compressor_, rgbx_.data(), int(width_), 0, int(height_), TJPF_RGBX, &buffer_, &size_,
                                  TJSAMP_420, quality_, 0) != 0)
    return Error{ErrorKind::internal, std::string("TurboJPEG: ") + tjGetErrorStr2(compressor_), {}, {}, {}};
  return millisecondsSince(start);
}

void BareEncoder::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    wake_.wait(lock, [&] { return asked_ || ending_; });
    if (ending_) return;
    asked_ = false;
    answer_ = encode();  // whoever could want the lock waits for this
    done_.notify_one();
  }
}

// ---- BareTransfer

class BareTransfer::Service final : public v1::ViewerService::CallbackService {
 public:
  explicit Service(const std::string& jpeg) {
    auto& frame = *message_.mutable_frame();
    frame.set_codec(v1::CODEC_JPEG);
    frame.set_data(jpeg);
  }

  grpc::ServerBidiReactor<v1::ViewerMessage, v1::ServerMessage>* Attach(grpc::CallbackServerContext*) override {
    return new Reactor(*this);
  }
  StreamClock::time_point started() const { return started_.load(); }

 private:
  class Reactor final : public grpc::ServerBidiReactor<v1::ViewerMessage, v1::ServerMessage> {
   public:
    explicit Reactor(Service& service) : service_(service) { StartRead(&in_); }
    void OnReadDone(bool ok) override {
      if (!ok) return Finish(grpc::Status::OK);
      service_.started_ = StreamClock::now();
      StartWrite(&service_.message_);
    }
    void OnWriteDone(bool ok) override {
      if (ok) StartRead(&in_);
      else Finish(grpc::Status::OK);
    }
    void OnDone() override { delete this; }

   private:
    Service& service_;
    v1::ViewerMessage in_;
  };

  v1::ServerMessage message_;
  std::atomic<StreamClock::time_point> started_{};
};

BareTransfer::BareTransfer(const std::string& jpeg) : service_(std::make_unique<Service>(jpeg)) {
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(service_.get());
  server_ = builder.BuildAndStart();
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  stub_ = v1::ViewerService::NewStub(
      grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(port), grpc::InsecureChannelCredentials(), arguments));
  stream_ = stub_->Attach(&context_);
}

BareTransfer::~BareTransfer() {
  stream_->WritesDone();
  stream_->Finish();
  server_->Shutdown();
}

Result<BareTransfer::Transferred> BareTransfer::once() {
  Transferred out;
  if (!stream_->Write(v1::ViewerMessage()) || !stream_->Read(&out.message))
    return Error{ErrorKind::internal, "the bare transfer's stream has ended", {}, {}, {}};
  out.milliseconds = millisecondsSince(service_->started());
  return out;
}

}  // namespace helio::bench
