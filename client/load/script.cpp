#include "load/script.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace helio::load {
namespace {

using namespace std::chrono_literals;

constexpr auto kCameraPeriod = 16ms;   // as a mouse at 60 Hz
constexpr auto kAfterFailure = 500ms;  // a client that fails does not hammer

/// Catmull-Rom through the positions, the shorter arc between the rotations; s in [0, views - 1].
client::View along(const std::vector<client::View>& views, float s) {
  const auto last = static_cast<int>(views.size()) - 1;
  const int i = std::clamp(static_cast<int>(s), 0, last - 1);
  const float t = s - float(i);
  const auto p = [&](int k) { return views[static_cast<size_t>(std::clamp(k, 0, last))].position; };
  const glm::vec3 a = p(i - 1), b = p(i), c = p(i + 1), d = p(i + 2);
  const glm::vec3 position = 0.5f * (2.0f * b + (c - a) * t + (2.0f * a - 5.0f * b + 4.0f * c - d) * t * t +
                                     (3.0f * (b - c) + d - a) * t * t * t);
  client::View view = client::between(views[size_t(i)], views[size_t(i) + 1], t);
  view.position = position;
  return view;
}

Error notFound(const std::string& what, const std::string& name, const std::string& world) {
  return {ErrorKind::not_found, "world \"" + world + "\" has no " + what + " \"" + name + "\"", what, name, {}};
}

v1::Settings settingsOf(const Group& group) {
  v1::Settings settings;
  settings.set_width(group.width);
  settings.set_height(group.height);
  settings.set_primary(group.primary == "traced" ? v1::PRIMARY_HITS_TRACED : v1::PRIMARY_HITS_RASTER);
  settings.set_bounces(group.bounces);
  settings.set_samples(group.samples);
  settings.mutable_stream()->set_max_fps(group.fps);
  settings.mutable_stream()->set_max_latency_ms(group.max_latency_ms);
  settings.mutable_stream()->set_jpeg_quality(group.quality);
  return settings;
}

}  // namespace

// ---- Curtain

bool Curtain::waitUntil(Clock::time_point when) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, std::min(when, end_), [&] { return fallen_; });
  return !fallen_ && when < end_;
}

bool Curtain::fallen() const {
  const std::lock_guard lock(mutex_);
  return fallen_ || Clock::now() >= end_;
}

void Curtain::fall() {
  const std::lock_guard lock(mutex_);
  fallen_ = true;
  changed_.notify_all();
}

// ---- Script

Script::Script(Part part, Curtain& curtain, Record& record)
    : part_(std::move(part)),
      curtain_(curtain),
      record_(record),
      random_(part_.seed),
      viewer_(record,
              {part_.stage->world.world(), settingsOf(*part_.group), part_.group->check_pictures, part_.measured_from}),
      here_(client::fromWire(part_.stage->world.cameras(0).camera())) {}

Result<std::unique_ptr<Script>> Script::prepare(Part part, Curtain& curtain, Record& record) {
  std::unique_ptr<Script> script(new Script(std::move(part), curtain, record));
  if (auto good = script->check(script->part_.group->steps); !good) return good.error();
  if (script->part_.group->relayed()) {
    auto relay = Relay::start(script->part_.server, script->part_.group->network, script->part_.seed + 1);
    if (!relay) return relay.error();
    script->relay_ = std::move(*relay);
  }
  return script;
}

Result<void> Script::check(const std::vector<Step>& steps) const {
  const std::string& world = part_.stage->world.world();
  for (const Step& step : steps) {
    std::vector<std::string> cameras;
    if (const auto* fly = std::get_if<Fly>(&step)) cameras = fly->through;
    if (const auto* jump = std::get_if<Jump>(&step); jump && !jump->camera.empty()) cameras = {jump->camera};
    for (const auto& camera : cameras)
      if (!cameraNamed(camera)) return notFound("camera", camera, world);
    if (const auto* build = std::get_if<BuildStep>(&step))
      if (auto prefab = choosePrefab(part_.stage->prefabs, build->prefab); !prefab) return prefab.error();
    if (const auto* mirror = std::get_if<LookAtMirror>(&step); mirror && part_.stage->mirrors.empty())
      return notFound("instance of prefab", mirror->prefab, world);
    if (const auto* repeat = std::get_if<Repeat>(&step))
      if (auto good = check(repeat->steps); !good) return good;
  }
  return {};
}

double Script::uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

void Script::run() {
  next_ = part_.start;
  if (curtain_.waitUntil(part_.start))
    for (uint32_t loop = 0; part_.group->loops == 0 || loop < part_.group->loops; ++loop)
      if (!all(part_.group->steps)) break;
  curtain_.waitUntil(Clock::time_point::max());
  viewer_.close();
}

bool Script::all(const std::vector<Step>& steps) {
  for (const Step& step : steps) {
    if (const auto* repeat = std::get_if<Repeat>(&step)) {
      for (uint32_t i = 0; i < repeat->times; ++i)
        if (!all(repeat->steps)) return false;
    } else if (!one(step)) {
      return false;
    }
  }
  return true;
}

/// Open loop: the next arrival, whether or not the last step has ended by then.
Clock::time_point Script::nextArrival() {
  const double rate = part_.group->rate;
  const auto arrival = next_;
  next_ += durationOf(part_.group->poisson ? std::exponential_distribution<double>(rate)(random_) : 1 / rate);
  return arrival;
}

bool Script::one(const Step& step) {
  const bool open = part_.group->open();
  const auto intended = open ? nextArrival() : Clock::now();
  if (!curtain_.waitUntil(intended)) return false;
  const auto done = std::visit([&](const auto& what) { return perform(what, intended); }, step);
  if (curtain_.fallen()) return false;  // what failed now, failed because of that
  record_.step();
  if (!done) record_.stepFailed(nameOf(step) + ": " + done.error().message);
  if (open) return true;
  auto pause = durationOf(uniform(part_.group->think_low, part_.group->think_high));
  if (!done) pause = std::max<Clock::duration>(pause, kAfterFailure);
  return curtain_.waitUntil(Clock::now() + pause);
}

// ---- Connections

client::Connection& Script::connection() {
  if (!connection_)
    connection_ = relay_ ? client::Connection::through(relay_->address(), part_.server)
                         : std::make_unique<client::Connection>(part_.server);
  return *connection_;
}

void Script::dropConnection() {
  viewer_.close();
  connection_.reset();
}

Result<void> Script::open(When intended, Series first) { return viewer_.attach(connection(), here_, intended, first); }

Result<void> Script::needAttached() const {
  if (viewer_.attached()) return {};
  return Error{ErrorKind::unavailable, "there is no stream any more: " + viewer_.lastWords(), {}, {}, {}};
}

Result<void> Script::perform(const Attach&, When intended) {
  if (viewer_.attached()) return {};  // a loop comes back to its first step
  return open(intended, kFirstFrame);
}

Result<void> Script::perform(const Reconnect&, When intended) {
  dropConnection();
  return open(intended, kReattach);
}

Result<void> Script::perform(const Vanish&, When) {
  if (auto attached = needAttached(); !attached) return attached;
  viewer_.expectEnd();
  relay_->cut();
  dropConnection();
  return {};
}

Result<void> Script::perform(const HalfOpen&, When) {
  if (auto attached = needAttached(); !attached) return attached;
  viewer_.expectEnd();
  relay_->freeze();
  dropConnection();
  return {};
}

// ---- Looking

const v1::NamedCamera* Script::cameraNamed(const std::string& name) const {
  for (const auto& camera : part_.stage->world.cameras())
    if (camera.name() == name) return &camera;
  return nullptr;
}

Result<void> Script::perform(const Fly& fly, When intended) {
  if (auto attached = needAttached(); !attached) return attached;
  std::vector<client::View> views = {here_};
  for (const auto& name : fly.through) views.push_back(client::fromWire(cameraNamed(name)->camera()));
  if (fly.through.empty())
    for (const auto& camera : part_.stage->world.cameras()) views.push_back(client::fromWire(camera.camera()));
  const auto end = intended + durationOf(fly.seconds);
  for (auto when = intended; when < end; when += kCameraPeriod) {
    if (!curtain_.waitUntil(when)) return {};
    if (auto attached = needAttached(); !attached) return attached;
    const double s = secondsBetween(intended, when) / fly.seconds;
    here_ = along(views, static_cast<float>(s * double(views.size() - 1)));
    viewer_.look(here_, false, when);
  }
  return {};
}

Result<void> Script::perform(const Jump& jump, When intended) {
  if (auto attached = needAttached(); !attached) return attached;
  const auto& cameras = part_.stage->world.cameras();
  if (jump.camera.empty() && cameras.size() > 1) {
    const int step = std::uniform_int_distribution<int>(1, cameras.size() - 1)(random_);
    camera_ = (camera_ + step) % cameras.size();
  }
  here_ = client::fromWire(jump.camera.empty() ? cameras.Get(camera_).camera() : cameraNamed(jump.camera)->camera());
  viewer_.jump(here_, intended);
  return {};
}

Result<void> Script::perform(const LookAtMirror&, When intended) {
  if (auto attached = needAttached(); !attached) return attached;
  const auto& mirrors = part_.stage->mirrors;
  here_ = mirrors[std::uniform_int_distribution<size_t>(0, mirrors.size() - 1)(random_)];
  viewer_.jump(here_, intended);
  return {};
}

Result<void> Script::perform(const StopReading& stop, When intended) {
  if (auto attached = needAttached(); !attached) return attached;
  viewer_.setReading(false);
  curtain_.waitUntil(intended + durationOf(stop.seconds));
  viewer_.setReading(true);
  return {};
}

Result<void> Script::perform(const Idle& idle, When intended) {
  curtain_.waitUntil(intended + durationOf(idle.seconds));
  return {};
}

// ---- Editing

Result<v1::ApplyEditsResponse> Script::apply(v1::ApplyEditsRequest request, When intended) {
  std::string id;  // of this client alone, so that a repeat is known as one
  for (int i = 0; i < 4; ++i) id += std::to_string(random_() % 1'000'000'000) + ".";
  request.set_request_id(id);
  auto answer = connection().apply(std::move(request));
  if (answer) {
    record_.took(kEdit, intended);
    record_.editAcknowledged();
    viewer_.edited(answer->seq(), intended);
  }
  return answer;
}

Result<void> Script::perform(const BuildStep& build, When intended) {
  const auto prefab = choosePrefab(part_.stage->prefabs, build.prefab);
  const auto request = part_.plot.build(*prefab, build.count);
  const auto answer = apply(request, intended);
  part_.plot.built(request, answer);
  if (!answer) return answer.error();
  return {};
}

Result<void> Script::perform(const DestroyStep&, When intended) {
  const auto answer = apply(part_.plot.destroy(), intended);
  part_.plot.destroyed(answer);
  if (!answer) return answer.error();
  return {};
}

Result<void> Script::perform(const Light& light, When intended) {
  constexpr double kDegree = std::numbers::pi / 180;
  v1::ApplyEditsRequest request;
  request.set_world(part_.stage->world.world());
  auto& daylight = *request.add_edits()->mutable_set_sun()->mutable_daylight();
  daylight.set_elevation(static_cast<float>(light.elevation.value_or(uniform(5, 85)) * kDegree));
  daylight.set_azimuth(static_cast<float>(light.azimuth.value_or(uniform(0, 360)) * kDegree));
  auto answer = apply(std::move(request), intended);
  if (!answer) return answer.error();
  return {};
}

}  // namespace helio::load
