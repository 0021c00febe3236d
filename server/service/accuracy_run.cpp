#include "service/accuracy_run.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "render/metrics/flip.h"
#include "render/reference.h"
#include "service/viewpoint.h"
#include "stream/picture.h"

namespace helio::service {
namespace {

constexpr size_t kChunkBytes = 256 << 10;  // as shots
constexpr uint32_t kUsualBounces = 8;      // of a reference: what is beyond is below its noise
// A step waits for idle time no longer than so many steps take: where there is none the streams lose a tenth.
constexpr int kPatience = 9;
constexpr auto kLeastPatience = std::chrono::milliseconds(50);

std::vector<uint8_t> displayed(const render::Pixels& pixels) {
  return {pixels.rgbx, pixels.rgbx + size_t{4} * pixels.width * pixels.height};
}

/// A picture that shows light, and is not larger than what can be compared.
Outcome<void> judgeable(const render::ViewSettings& settings, const Limits& limits) {
  const auto invalid = [](std::string what) {
    return Failure(Error{ErrorKind::invalid,
                         "the picture shows " + what + " and no light: there is no error to measure", "request.view",
                         what, "pictures of light"});
  };
  if (showsProperty(settings.materials)) return invalid("a property of materials");
  if (settings.inspect != render::Inspect::nothing) return invalid("numbers for inspection");
  if (settings.culling_view != render::CullingView::none) return invalid("what culling did");
  const uint64_t pixels = uint64_t{settings.width} * settings.height;
  if (pixels > limits.max_accuracy_pixels)
    return beyondLimit("pixels", std::to_string(pixels), std::to_string(limits.max_accuracy_pixels),
                       "this server compares pictures of " + std::to_string(limits.max_accuracy_pixels) +
                           " pixels at most; ask with a smaller size");
  return {};
}

Failure unknownViewer(uint64_t viewer, const std::string& world) {
  return Failure(
      Error{ErrorKind::not_found,
            "world \"" + world + "\" has no viewer " + std::to_string(viewer) + "; helio top shows their numbers",
            "request.viewer",
            std::to_string(viewer),
            {}});
}

struct Comparison {
  v1::AccuracyResult result;
  std::vector<std::pair<std::string, std::string>> pictures;  // name, PNG
};

Outcome<Comparison> compare(const Captured& live, const render::ReferencePicture& reference,
                            const metrics::Image& first_half, bool pictures) {
  const auto& stats = live.frame.stats;
  const uint32_t width = live.settings.width, height = live.settings.height;
  const metrics::Image image{width, height, live.frame.radiance}, truth = reference.image();
  const auto shown = displayed(*live.frame.pixels), shown_truth = displayed(reference.pixels());
  const auto differences = metrics::SeenPicture(shown_truth.data(), width, height)
                               .differences(metrics::SeenPicture(shown.data(), width, height));
  Comparison comparison;
  auto& result = comparison.result;
  result.set_tick(stats.tick);
  result.set_applied_seq(stats.applied_seq);
  result.set_time(stats.time);
  result.set_accumulated(stats.accumulated);
  result.set_exposure(static_cast<float>(stats.exposure));
  result.set_relative_mse(metrics::relativeMse(image, truth));
  const uint32_t samples = reference.samples(), half = samples / 2;
  result.set_reference_noise(metrics::noiseFloor(first_half, metrics::rest(truth, samples, first_half, half)));
  result.set_ssim(metrics::ssim(metrics::lumas(shown), metrics::lumas(shown_truth), width, height));
  result.set_flip(std::accumulate(differences.begin(), differences.end(), 0.0) /
                  static_cast<double>(differences.size()));
  result.set_samples(samples);
  result.set_gpu_ms(reference.gpuMs());
  if (!pictures) return comparison;
  const auto error = metrics::heat(differences);
  for (const auto& [name, pixels] : {std::pair{"live", &shown}, {"reference", &shown_truth}, {"error", &error}}) {
    auto png = stream::encodePng({pixels->data(), width, height});
    if (!png) return Failure(png.error());
    auto* picture = result.add_pictures();
    picture->set_name(name);
    picture->set_size(png->size());
    comparison.pictures.emplace_back(name, std::move(*png));
  }
  return comparison;
}

}  // namespace

// ---- The call
// --------------------------------------------------------------------------------------------------------

AccuracyRun* AccuracyRun::open(const StreamEnvironment& environment, grpc::CallbackServerContext& context,
                               const v1::MeasureAccuracyRequest& request) {
  std::shared_ptr<AccuracyRun> run(new AccuracyRun(environment, context));
  run->self_ = run;
  if (auto begun = run->begin(request); !begun) {
    run->leave();
    run->aside_.reset();
    {
      std::lock_guard lock(run->mutex_);
      run->done_ = true;
    }
    run->end(begun.error());
  }
  return run.get();
}

Outcome<AccuracySettings> AccuracyRun::settingsOf(const v1::MeasureAccuracyRequest& request, const HostedWorld& world,
                                                  const Caller& caller) const {
  const Limits& limits = *environment_.limits;
  AccuracySettings settings;
  const auto within = [](const char* field, uint32_t value, uint32_t low, uint32_t high) -> Outcome<void> {
    if (value >= low && value <= high) return {};
    return outOfRange(field, std::to_string(value), "[" + std::to_string(low) + ", " + std::to_string(high) + "]");
  };
  if (request.samples() != 0) settings.samples = request.samples();
  if (auto ok = within("request.samples", settings.samples, 2, limits.max_shot_samples); !ok) return ok.error();
  settings.samples += settings.samples % 2;  // halves tell the noise
  if (request.has_bounces()) settings.bounces = request.bounces();
  if (auto ok = within("request.bounces", request.bounces(), 0, 32); !ok) return ok.error();
  settings.pictures = request.pictures();
  if (request.view_case() == v1::MeasureAccuracyRequest::kViewer) {
    if (auto allowed = checkViewer(request.viewer(), world, caller); !allowed) return allowed.error();
    settings.viewer = request.viewer();
    return settings;
  }
  auto picture = fromWire(request.settings(), limits);
  if (!picture) return picture.error();
  if (auto shows = judgeable(picture->view, limits); !shows) return shows.error();
  settings.picture = *picture;
  if (request.frames() != 0) settings.frames = request.frames();
  if (auto ok = within("request.frames", settings.frames, 1, 1024); !ok) return ok.error();
  auto content = world.content();
  if (!content) return content.error();
  auto camera = viewpointOf(request, (*content)->scene(), limits);
  if (!camera) return camera.error();
  settings.camera = *camera;
  return settings;
}

Outcome<void> AccuracyRun::checkViewer(uint64_t viewer, const HostedWorld& world, const Caller& caller) const {
  for (const auto& status : world.viewerStatus()) {
    if (status.id != viewer) continue;
    if (caller.token && caller.token->id != status.token && caller.token->scope < access::Scope::admin)
      return Failure(
          v1::ERROR_REASON_FORBIDDEN,
          {ErrorKind::invalid,
           "viewer " + std::to_string(viewer) + " belongs to another token: to see its picture takes scope " +
               access::nameOf(access::Scope::admin),
           "authorization", access::nameOf(caller.token->scope), access::nameOf(access::Scope::admin)});
    return judgeable(status.settings, *environment_.limits);
  }
  return unknownViewer(viewer, world.name());
}

Outcome<void> AccuracyRun::begin(const v1::MeasureAccuracyRequest& request) {
  const auto caller = environment_.access->admit(context_, "RenderService.MeasureAccuracy", request);
  if (!caller) return caller.error();
  auto world = environment_.worlds->find(request.world());
  if (!world) return world.error();
  if (auto content = (*world)->content(); !content) return content.error();
  auto settings = settingsOf(request, **world, *caller);
  if (!settings) return settings.error();
  settings_ = *settings;
  aside_ = (*world)->admitAside();
  if (!aside_)
    return beyondLimit("world", request.world(), "1",
                       "somebody measures the accuracy of world \"" + request.world() +
                           "\" already, and a copy of it at a time is enough; try again later");
  auto place = environment_.worlds->admitViewer();
  if (!place) return place.error();
  place_ = *place;
  world_ = *world;
  session_ = environment_.access->enter(*caller, [weak = weak_from_this()](const Failure& why, bool at_once) {
    const auto run = weak.lock();
    if (!run) return;
    if (at_once) return run->context_.TryCancel();
    run->leave();
    run->end(why);
  });
  if (!settings_.viewer) frames_left_ = settings_.frames;
  done_ = false;
  if (auto attached = world_->attach(shared_from_this()); !attached) return attached.error();
  if (settings_.viewer && !world_->capture(*settings_.viewer, captureHere()))
    return unknownViewer(*settings_.viewer, world_->name());
  std::lock_guard lock(mutex_);
  thread_ = std::thread([this] { run(); });
  return {};
}

void AccuracyRun::end(const Failure& failure) {
  std::lock_guard lock(mutex_);
  if (ending_ || finished_) return;
  // What was measured needs the world no more.
  if (measured_ && failure.reason != v1::ERROR_REASON_UNAUTHENTICATED) return;
  ending_ = failure;
  wake_.notify_all();
  pump();
}

void AccuracyRun::pump() {
  if (writing_ || finished_) return;
  if (gone_ || ending_) {
    if (done_) finish(gone_ ? grpc::Status::CANCELLED : toStatus(*ending_, context_));
    return;
  }
  if (progress_) {
    out_ = *std::exchange(progress_, std::nullopt);
  } else if (!events_.empty()) {
    out_ = std::move(events_.front());
    events_.pop_front();
  } else {
    if (done_) finish(grpc::Status::OK);
    return;
  }
  writing_ = true;
  StartWrite(&out_);
}

void AccuracyRun::finish(grpc::Status status) {
  finished_ = true;
  Finish(std::move(status));
}

void AccuracyRun::OnWriteDone(bool ok) {
  std::lock_guard lock(mutex_);
  writing_ = false;
  if (!ok) gone_ = true;
  wake_.notify_all();
  pump();
}

void AccuracyRun::OnCancel() {
  leave();
  std::lock_guard lock(mutex_);
  gone_ = true;
  wake_.notify_all();
  pump();
}

void AccuracyRun::leave() {
  if (world_) world_->detach(this);
}

void AccuracyRun::OnDone() {
  leave();
  if (thread_.joinable()) thread_.join();  // it has nothing left to do
  place_.reset();
  session_.reset();
  self_.reset();
}

// ---- From the world's thread
// -----------------------------------------------------------------------------------------

Capture AccuracyRun::captureHere() {
  return [weak = weak_from_this()](Captured picture) {
    const auto run = weak.lock();
    if (!run) return;
    std::lock_guard lock(run->mutex_);
    run->captured_ = std::move(picture);
    run->taken_ = true;
    run->wake_.notify_all();
  };
}

std::optional<Clock::time_point> AccuracyRun::wantedFrom(Clock::time_point now) {
  std::lock_guard lock(mutex_);
  if (frames_left_ == 0 || ending_ || gone_) return std::nullopt;
  return now;
}

ViewDemand AccuracyRun::demand(Clock::time_point) {
  std::lock_guard lock(mutex_);
  return {settings_.camera, settings_.picture.view, frames_left_ == 1 ? captureHere() : Capture()};
}

void AccuracyRun::deliver(render::Frame, Clock::duration) {
  std::lock_guard lock(mutex_);
  --frames_left_;
}

/// A viewer that left takes no picture any more.
void AccuracyRun::tend(Clock::time_point) {
  {
    std::lock_guard lock(mutex_);
    if (taken_ || !settings_.viewer) return;
  }
  const auto all = world_->viewerStatus();
  if (std::any_of(all.begin(), all.end(), [&](const auto& status) { return status.id == *settings_.viewer; })) return;
  end(Failure(Error{ErrorKind::not_found,
                    "viewer " + std::to_string(*settings_.viewer) + " left before its next picture",
                    "request.viewer",
                    std::to_string(*settings_.viewer),
                    {}}));
}

// ---- The reference
// ---------------------------------------------------------------------------------------------------

void AccuracyRun::run() {
  auto measured = measure();
  leave();
  aside_.reset();  // before the client can know: it may ask again at once
  if (!measured) end(measured.error());
  std::lock_guard lock(mutex_);
  done_ = true;
  pump();
}

bool AccuracyRun::over() {
  std::lock_guard lock(mutex_);
  return gone_ || ending_;
}

std::optional<Captured> AccuracyRun::awaitPicture() {
  std::unique_lock lock(mutex_);
  wake_.wait(lock, [&] { return captured_ || gone_ || ending_; });
  if (gone_ || ending_) return std::nullopt;
  return std::exchange(captured_, std::nullopt);
}

void AccuracyRun::report(uint32_t samples, double relative_mse) {
  std::lock_guard lock(mutex_);
  auto& progress = *progress_.emplace().mutable_progress();
  progress.set_samples(std::min(samples, settings_.samples));
  progress.set_wanted(settings_.samples);
  progress.set_relative_mse(relative_mse);
  pump();
}

Outcome<void> AccuracyRun::measure() {
  report(0, 0.0);
  auto live = awaitPicture();
  if (!live) return {};
  if (auto shows = judgeable(live->settings, *environment_.limits); !shows) return shows;
  const metrics::Image image{live->settings.width, live->settings.height, live->frame.radiance};
  const uint32_t bounces = settings_.bounces.value_or(std::max(kUsualBounces, live->settings.bounces));
  auto reference =
      render::ReferencePicture::make(*environment_.renderer, live->scene, std::move(live->world), live->camera,
                                     render::referenceOf(live->settings, bounces, live->frame.stats.exposure));
  if (!reference) return Failure(reference.error());
  metrics::Image first_half;
  uint32_t reported = 0;
  Clock::duration step{};
  while ((*reference)->samples() < settings_.samples) {
    if (over()) return {};
    world_->awaitIdle(step, Clock::now() + std::max<Clock::duration>(kPatience * step, kLeastPatience));
    const auto start = Clock::now();
    if (auto grown = (*reference)->grow(1); !grown) return Failure(grown.error());
    step = Clock::now() - start;
    const uint32_t samples = (*reference)->samples();
    if (samples == settings_.samples / 2) first_half = (*reference)->image();
    // A look at the error costs about as much as a sample of a small picture: about a hundred will do.
    if (samples < reported) reported = 0;  // the mean has begun again
    if (samples - reported < std::max(1u, settings_.samples / 100)) continue;
    reported = samples;
    report(samples, metrics::relativeMse(image, (*reference)->image()));
  }
  auto comparison = compare(*live, **reference, first_half, settings_.pictures);
  if (!comparison) return comparison.error();
  auto& result = comparison->result;
  result.set_bounces(bounces);
  ViewerSettings as_shown;
  as_shown.view = live->settings;
  *result.mutable_settings() = toWire(as_shown);
  if (const auto belief = render::believe(*environment_.prices, live->settings, live->frame.stats))
    *result.mutable_estimate() = toWire(*belief);
  std::lock_guard lock(mutex_);
  measured_ = true;
  *events_.emplace_back().mutable_result() = std::move(result);
  for (const auto& [name, png] : comparison->pictures)
    for (size_t sent = 0; sent < png.size(); sent += kChunkBytes)
      events_.emplace_back().mutable_chunk()->set_data(png.substr(sent, kChunkBytes));
  pump();
  return {};
}

}  // namespace helio::service
