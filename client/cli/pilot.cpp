#include "cli/pilot.h"

#include <algorithm>
#include <cmath>
#include <thread>
#include <utility>

namespace helio::cli {
namespace {

using client::Clock;
using namespace std::chrono_literals;

constexpr auto kCameraPeriod = 16ms;  // as a mouse at 60 Hz
constexpr size_t kViewsKept = 10'000;
constexpr float kNeighbourhood = 300;  // metres in which a building site takes its height from its neighbours
constexpr size_t kMostNeighbours = 5'000;

std::string categoryOf(const std::string& name) {
  const std::string prefix = "category:";
  return name.rfind(prefix, 0) == 0 ? name.substr(prefix.size()) : std::string();
}

}  // namespace

Pilot::Pilot(client::Connection& connection, client::ViewerSession& session, std::string world, Tour tour)
    : connection_(connection), session_(session), world_(std::move(world)), tour_(std::move(tour)) {}

Result<std::unique_ptr<Pilot>> Pilot::prepare(client::Connection& connection, client::ViewerSession& session,
                                              const v1::World& world, Tour tour) {
  std::unique_ptr<Pilot> pilot(new Pilot(connection, session, world.world(), std::move(tour)));
  for (const auto& named : world.cameras()) pilot->cameras_[named.name()] = client::fromWire(named.camera());
  pilot->here_ = client::fromWire(world.cameras(0).camera());
  auto prefabs = connection.prefabs(world.world());
  if (!prefabs) return prefabs.error();
  pilot->prefabs_ = std::move(*prefabs);

  const auto missing = [&](const std::string& what, const std::string& name) {
    return Error{ErrorKind::not_found,
                 "world \"" + world.world() + "\" has no " + what + " \"" + name + "\", which the tour asks for",
                 what,
                 name,
                 {}};
  };
  for (const auto& step : pilot->tour_.steps) {
    std::vector<std::string> cameras;
    if (const auto* jump = std::get_if<Jump>(&step.what)) cameras = {jump->camera};
    if (const auto* fly = std::get_if<Fly>(&step.what)) cameras = {fly->from, fly->to};
    for (const auto& camera : cameras)
      if (camera != "here" && !pilot->cameras_.count(camera)) return missing("camera", camera);
    if (const auto* build = std::get_if<BuildStep>(&step.what))
      if (pilot->prefabsFor(build->prefab).empty()) return missing("buildable prefab", build->prefab);
  }
  return pilot;
}

std::vector<const v1::Prefab*> Pilot::prefabsFor(const std::string& name) const {
  std::vector<const v1::Prefab*> out;
  const std::string category = categoryOf(name);
  for (const auto& prefab : prefabs_)
    if (prefab.buildable() && (prefab.name() == name || (!category.empty() && prefab.category() == category)))
      out.push_back(&prefab);
  return out;
}

Result<void> Pilot::run() {
  auto end = Clock::now();
  for (const auto& step : tour_.steps) {
    if (stopped_) break;
    end += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(step.seconds));
    step_seconds_ = step.seconds;
    auto done = std::visit([&](const auto& what) { return perform(what); }, step.what);
    if (!done) return done;
    waitUntil(end);
    end = std::max(end, Clock::now() - 1s);  // an edit that took long must not squeeze what follows
  }
  return {};
}

void Pilot::waitUntil(Clock::time_point when) {
  while (!stopped_ && Clock::now() < when)
    std::this_thread::sleep_for(std::min<Clock::duration>(when - Clock::now(), 50ms));
}

uint64_t Pilot::look(const client::View& view, bool cut) {
  auto camera = client::toWire(view);
  camera.set_cut(cut);
  here_ = view;
  std::lock_guard lock(mutex_);
  const uint64_t id = session_.look(std::move(camera));
  views_[id] = view;
  if (views_.size() > kViewsKept) views_.erase(views_.begin());
  return id;
}

Result<void> Pilot::perform(const Jump& jump) {
  const auto sent = Clock::now();
  mark({"jump to " + jump.camera, sent, look(cameras_.at(jump.camera), true), 0});
  return {};
}

Result<void> Pilot::perform(const Fly& fly) {
  const client::View from = fly.from == "here" ? here_ : cameras_.at(fly.from);
  const client::View to = fly.to == "here" ? here_ : cameras_.at(fly.to);
  const auto start = Clock::now();
  mark({"fly to " + fly.to, start, look(from, fly.from != "here"), 0});
  for (double s = 0; s < 1 && !stopped_;) {
    std::this_thread::sleep_for(kCameraPeriod);
    const double elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    s = step_seconds_ > 0 ? std::min(1.0, elapsed / step_seconds_) : 1.0;
    look(client::between(from, to, static_cast<float>(s)), false);
  }
  return {};
}

glm::vec2 Pilot::resolve(const Place& place) const {
  if (!place.ahead) return place.at;
  const glm::vec3 forward = here_.forward();
  const glm::vec2 level(forward.x, forward.z);
  const float length = glm::length(level);
  const glm::vec2 direction = length > 1e-3f ? level / length : glm::vec2(0, -1);
  return glm::vec2(here_.position.x, here_.position.z) + *place.ahead * direction;
}

Result<void> Pilot::perform(const BuildStep& build) {
  const auto prefabs = prefabsFor(build.prefab);
  const glm::vec2 centre = resolve(build.place);

  // The ground's height is not known here: stand as high as the nearest instance of the same category.
  auto instances = connection_.instances(world_, centre.x, centre.y, kNeighbourhood, kMostNeighbours);
  if (!instances) return instances.error();
  std::map<std::string, std::string> category;
  for (const auto& prefab : prefabs_) category[prefab.name()] = prefab.category();
  std::vector<glm::vec3> neighbours;
  for (const auto& instance : *instances)
    if (category[instance.prefab()] == prefabs.front()->category())
      neighbours.emplace_back(instance.transform(9), instance.transform(10), instance.transform(11));
  const auto height = [&](const glm::vec2& at) {
    const auto distance = [&](const glm::vec3& n) { return glm::length(glm::vec2(n.x, n.z) - at); };
    const auto nearest = std::min_element(neighbours.begin(), neighbours.end(),
                                          [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    return nearest == neighbours.end() ? 0.0f : nearest->y;
  };

  // A square grid with a quarter of the largest prefab between two.
  float spacing = 1;
  for (const auto* prefab : prefabs) {
    const auto& low = prefab->bounds().min();
    const auto& high = prefab->bounds().max();
    spacing = std::max({spacing, 1.25f * (high.x() - low.x()), 1.25f * (high.z() - low.z())});
  }
  const uint32_t side = static_cast<uint32_t>(std::ceil(std::sqrt(double(build.count))));
  v1::ApplyEditsRequest request;
  request.set_world(world_);
  std::map<const v1::Prefab*, v1::Build*> builds;
  for (uint32_t i = 0; i < build.count; ++i) {
    const glm::vec2 cell(float(i % side) - 0.5f * float(side - 1), float(i / side) - 0.5f * float(side - 1));
    const glm::vec2 at = centre + spacing * cell;
    const auto* prefab = prefabs[i % prefabs.size()];
    auto*& edit = builds[prefab];
    if (!edit) {
      edit = request.add_edits()->mutable_build();
      edit->set_prefab(prefab->name());
    }
    for (const float number : {at.x, height(at), at.y, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}) edit->add_placements(number);
  }
  const auto sent = Clock::now();
  auto answer = connection_.apply(std::move(request));
  if (!answer) return answer.error();
  mark({"built " + std::to_string(build.count) + " x " + prefabs.front()->category(), sent, 0, answer->seq()});
  return {};
}

Result<v1::ApplyEditsResponse> Pilot::apply(v1::Edit edit) {
  v1::ApplyEditsRequest request;
  request.set_world(world_);
  *request.add_edits() = std::move(edit);
  sent_ = Clock::now();
  return connection_.apply(std::move(request));
}

Result<void> Pilot::perform(const DestroyStep& destroy) {
  v1::Edit edit;
  const glm::vec2 centre = resolve(destroy.place);
  edit.mutable_destroy_region()->set_x(centre.x);
  edit.mutable_destroy_region()->set_z(centre.y);
  edit.mutable_destroy_region()->set_radius(destroy.radius);
  auto answer = apply(std::move(edit));
  if (!answer) return answer.error();
  mark({"destroyed " + std::to_string(answer->destroyed()) + " instances", sent_, 0, answer->seq()});
  return {};
}

Result<void> Pilot::perform(const SunStep& sun) {
  v1::Edit edit;
  auto& daylight = *edit.mutable_set_sun()->mutable_daylight();
  daylight.set_elevation(static_cast<float>(radians(sun.elevation)));
  daylight.set_azimuth(static_cast<float>(radians(sun.azimuth)));
  auto answer = apply(std::move(edit));
  if (!answer) return answer.error();
  char label[64];
  std::snprintf(label, sizeof label, "sun at %g degrees", sun.elevation);
  mark({label, sent_, 0, answer->seq()});
  return {};
}

void Pilot::mark(Mark mark) {
  std::lock_guard lock(mutex_);
  marks_.push_back(std::move(mark));
}

std::vector<Mark> Pilot::marks() const {
  std::lock_guard lock(mutex_);
  return marks_;
}

std::optional<client::View> Pilot::viewOf(uint64_t camera_id) const {
  std::lock_guard lock(mutex_);
  const auto found = views_.find(camera_id);
  if (found == views_.end()) return std::nullopt;
  return found->second;
}

}  // namespace helio::cli
