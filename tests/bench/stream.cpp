#include "bench/stream.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <thread>

#include "bench/progress.h"
#include "bench/report.h"
#include "bench/stage.h"
#include "bench/statistics.h"
#include "bench/stream_parts.h"
#include "lib/jpeg_decoder.h"
#include "lib/viewer_session.h"
#include "service/server.h"
#include "store/edit_log.h"

namespace helio::bench {
namespace {

constexpr const char* kNotes =
    R"(What is measured, a round each in turn, each after the same rest and on threads that slept:
  encode     TurboJPEG alone, into memory that is used again
  transfer   gRPC's callback API alone: one message of that size, from the server's write to the client's read
  decode     TurboJPEG alone, of what was transferred
  whole      heliographd's own path, from the renderer's return to the decoded picture at the client
overhead: the whole over the sum of the three in the same round, in per cent. The JPEG is the same on both ways, byte for
byte. Everything is in this process, on loopback.

Examples:
  helio-bench stream
  helio-bench stream --size 1920x1080 --frames 500 --json)";

constexpr int kQuality = 80;
constexpr unsigned kFps = 60;
constexpr unsigned kLongLatencyMs = 60'000;  // no frame is dropped, and no queue lowers the quality
// Before either way, so that both find threads, cores and caches as a server finds them between two frames.
constexpr auto kRest = std::chrono::milliseconds(10);

struct StreamOptions {
  uint32_t width = 1280, height = 720;
  size_t frames = 300, warmup = 30;
  bool json = false;
};

using client::JpegDecoder;

double milliseconds(StreamClock::duration d) { return std::chrono::duration<double, std::milli>(d).count(); }

/// A server with one viewer.
class WholePath {
 public:
  static Result<std::unique_ptr<WholePath>> start(FixedRenderer& renderer, const StreamOptions& options) {
    std::unique_ptr<WholePath> path(new WholePath(renderer));
    service::ServerConfig config;
    config.address = "127.0.0.1:0";
    auto server = service::Server::start(std::move(config), renderer, *path->log_);
    if (!server) return server.error();
    path->server_ = std::move(*server);
    if (auto made = path->server_->createCity("bench", {1, 1000}); !made) return made.error();
    path->connection_ = std::make_unique<client::Connection>(path->server_->address());
    client::ViewerSession::Options viewer;
    viewer.world = "bench";
    viewer.settings.set_width(options.width);
    viewer.settings.set_height(options.height);
    auto& limit = *viewer.settings.mutable_stream();
    limit.set_max_fps(kFps);
    limit.set_max_latency_ms(kLongLatencyMs);
    limit.set_jpeg_quality(kQuality);
    limit.set_still_quality(kQuality);  // the camera never moves
    auto session = client::ViewerSession::attach(*path->connection_, viewer);
    if (!session) return session.error();
    path->session_ = std::move(*session);
    return path;
  }

  ~WholePath() { renderer_.open(); }  // the world's thread may wait in it

  /// Milliseconds from a picture's return by the renderer to its pixels here. The JPEG must be `expected`.
  Result<double> once(const std::string& expected, JpegDecoder& decoder, JpegDecoder::Image& image) {
    renderer_.release();
    auto received = session_->next();
    if (!received) return received.error();
    if (!*received) return Error{ErrorKind::internal, "the stream has ended", {}, {}, {}};
    const v1::Frame& frame = (*received)->frame;
    if (auto decoded = decoder.decode(frame.data(), image); !decoded) return decoded.error();
    const auto now = StreamClock::now();
    session_->shown(**received, now);
    if (frame.data() != expected)
      return Error{ErrorKind::internal,
                   "the server's JPEG (" + std::to_string(frame.data().size()) + " bytes, quality " +
                       std::to_string(frame.telemetry().jpeg_quality()) + ") is not the bare encoder's (" +
                       std::to_string(expected.size()) + " bytes, quality " + std::to_string(kQuality) +
                       "): their times cannot be compared",
                   {},
                   {},
                   {}};
    const auto& stages = frame.telemetry().stages();
    mailbox_.push_back(stages.mailbox_us() / 1000.0);
    encode_.push_back(stages.encode_us() / 1000.0);
    queue_.push_back(stages.queue_us() / 1000.0);
    return milliseconds(now - renderer_.rendered(frame.tick()));
  }

  /// The server's own account of its stages, milliseconds.
  std::vector<double> mailbox_, encode_, queue_;

 private:
  explicit WholePath(FixedRenderer& renderer) : renderer_(renderer) {}

  FixedRenderer& renderer_;
  std::unique_ptr<store::EditLog> log_ = store::makeMemoryEditLog();
  std::unique_ptr<service::Server> server_;
  std::unique_ptr<client::Connection> connection_;
  std::unique_ptr<client::ViewerSession> session_;
};

struct Measured {
  std::vector<double> encode, transfer, decode, sum, whole, overhead;
  std::vector<double> mailbox, service_encode, queue;
  size_t bytes = 0;
};

/// One frame by the bare parts, in the order in which the whole path needs them.
struct BareRound {
  double encode, transfer, decode;
  double sum() const { return encode + transfer + decode; }
};

Result<BareRound> bareRound(BareEncoder& encoder, BareTransfer& transfer, JpegDecoder& decoder,
                            JpegDecoder::Image& image) {
  const auto encoded = encoder.once();
  if (!encoded) return encoded.error();
  const auto transferred = transfer.once();
  if (!transferred) return transferred.error();
  const auto start = StreamClock::now();
  if (auto decoded = decoder.decode(transferred->message.frame().data(), image); !decoded) return decoded.error();
  return BareRound{*encoded, transferred->milliseconds, milliseconds(StreamClock::now() - start)};
}

Result<Measured> measure(const StreamOptions& options) {
  const auto rgbx = streamPicture(options.width, options.height);
  BareEncoder encoder(rgbx, options.width, options.height, kQuality);
  JpegDecoder decoder;
  JpegDecoder::Image image;
  if (auto encoded = encoder.once(); !encoded) return encoded.error();
  const std::string jpeg = encoder.jpeg();
  BareTransfer transfer(jpeg);
  FixedRenderer renderer(rgbx.data(), options.width, options.height);
  auto whole = WholePath::start(renderer, options);
  if (!whole) return whole.error();

  Measured out;
  out.bytes = jpeg.size();
  Progress progress("streaming", options.warmup + options.frames);
  for (size_t round = 0; round < options.warmup + options.frames; ++round) {
    std::this_thread::sleep_for(kRest);
    const auto bare = bareRound(encoder, transfer, decoder, image);
    if (!bare) return bare.error();
    std::this_thread::sleep_for(kRest);
    const auto w = (*whole)->once(jpeg, decoder, image);
    if (!w) return w.error();
    progress.step();
    if (round < options.warmup) continue;
    out.encode.push_back(bare->encode);
    out.transfer.push_back(bare->transfer);
    out.decode.push_back(bare->decode);
    out.sum.push_back(bare->sum());
    out.whole.push_back(*w);
    out.overhead.push_back(100 * (*w / bare->sum() - 1));
  }
  const auto measured = [&](const std::vector<double>& all) {
    return std::vector<double>(all.end() - static_cast<std::ptrdiff_t>(options.frames), all.end());
  };
  out.mailbox = measured((*whole)->mailbox_);
  out.service_encode = measured((*whole)->encode_);
  out.queue = measured((*whole)->queue_);
  return out;
}

void print(const StreamOptions& options, const Measured& measured, const std::string& command) {
  const Provenance from = provenance({"the CPU", "TurboJPEG and gRPC", true}, command);
  const std::pair<const char*, const std::vector<double>*> rows[] = {{"encode", &measured.encode},
                                                                     {"transfer", &measured.transfer},
                                                                     {"decode", &measured.decode},
                                                                     {"sum", &measured.sum},
                                                                     {"whole", &measured.whole}};
  const std::pair<const char*, const std::vector<double>*> stages[] = {
      {"mailbox", &measured.mailbox}, {"encode", &measured.service_encode}, {"queue", &measured.queue}};
  const double overhead = median(measured.overhead);
  if (options.json) {
    Json json = {{"schema", "heliograph.bench.stream/1"}};
    append(json, from);
    json["size"] = {{"width", options.width}, {"height", options.height}};
    json["frames"] = options.frames;
    json["jpeg_bytes"] = measured.bytes;
    const auto quantiles = [](const std::vector<double>& values) {
      return Json{{"p50", percentile(values, 50)}, {"p99", percentile(values, 99)}};
    };
    for (const auto& [name, values] : rows) json[std::string(name) + "_ms"] = quantiles(*values);
    json["overhead"] = overhead / 100;
    json["overhead_percent"] = quantiles(measured.overhead);
    for (const auto& [name, values] : stages) json["service_stages_ms"][name] = quantiles(*values);
    std::cout << json.dump(2) << std::endl;
    return;
  }
  Table table({"ms", "p50", "p99"});
  const auto add = [&](const std::string& name, const std::vector<double>& values) {
    table.add({name, fixed(percentile(values, 50), 3), fixed(percentile(values, 99), 3)});
  };
  for (const auto& [name, values] : rows) add(name, *values);
  for (const auto& [name, values] : stages) add(std::string("of the whole, ") + name, *values);
  std::cout << markdown(from) << "\n"
            << options.width << " x " << options.height << ", " << options.frames << " frames, a JPEG of "
            << grouped(measured.bytes) << " bytes\n\n"
            << table.markdown() << "\noverhead " << fixed(overhead, 1) << " % (median of the rounds)\n";
}

Result<void> measureStream(const StreamOptions& options, const std::string& command) {
  const auto measured = measure(options);
  if (!measured) return measured.error();
  print(options, *measured, command);
  return {};
}

}  // namespace

void addStreamCommand(CLI::App& app, const std::string& command_line, Action& chosen) {
  const auto options = std::make_shared<StreamOptions>();
  CLI::App& command =
      *app.add_subcommand("stream", "times a frame's way to the client, beside bare codec and bare transport");
  command.footer(kNotes);
  addSizeOption(command, options->width, options->height);
  const auto count = CLI::Range(1, 1'000'000).description("");
  command.add_option("--frames", options->frames, "measured, 1 to 1,000,000")->capture_default_str()->check(count);
  command.add_option("--warmup", options->warmup, "rounds before the first measured one, 1 to 1,000,000")
      ->capture_default_str()
      ->check(count);
  command.add_flag("--json", options->json, "one JSON document, schema heliograph.bench.stream/1");
  command.callback([&chosen, options, command_line] {
    chosen = [options, command_line] { return measureStream(*options, command_line); };
  });
}

}  // namespace helio::bench
