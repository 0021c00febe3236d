#include "render/controller.h"

#include <spdlog/fmt/fmt.h>
#include <algorithm>
#include <cmath>

#include "base/median.h"

namespace helio::render {
namespace {

constexpr size_t kWindow = 64;           // frames that predictions look back on
constexpr size_t kRecent = 4;            // of those, what a step down has to fit
constexpr size_t kLateOf = 20;           // of so many frames ...
constexpr size_t kLate = 2;              // ... so many late ones are more than 5 of 100
constexpr double kRoom = 0.9;            // of the goal: what a step up may take
constexpr double kComfort = 0.95;        // of the goal: what a step down must fit
constexpr double kWellWithin = 0.75;     // of the greatest error: what a quicker rung must be within
constexpr size_t kVariances = 9;         // whose median counts
constexpr uint32_t kSettling = 6;        // frames on a rung until it is judged by its error, or by what it really costs
constexpr uint32_t kSettlingStill = 64;  // likewise of a picture that stands still and gets better by itself
constexpr uint32_t kPatience = 12, kMostPatience = 1024;
constexpr double kMostCorrection = 4.0;  // of a price by one step

template <typename Values>
double medianOf(const Values& values) {
  return median(std::vector<double>(values.begin(), values.end()));
}

template <typename T>
void keep(std::deque<T>& values, const T& value, size_t most) {
  values.push_back(value);
  if (values.size() > most) values.pop_front();
}

const char* nameOf(size_t rung) { return kLadder[rung].name; }

}  // namespace

Result<void> check(const Goal& goal) {
  const bool time = goal.kind == Goal::Kind::max_frame_ms;
  const double most = time ? 10'000.0 : 10.0;
  if (goal.value > 0.0 && goal.value <= most) return {};
  const std::string field = time ? "goal.max_frame_ms" : "goal.max_error", limit = time ? "(0, 10000]" : "(0, 10]";
  return Error{ErrorKind::invalid, fmt::format("{} is {}; it must be in {}", field, goal.value, limit), field,
               fmt::format("{}", goal.value), limit};
}

Observation observe(const FrameStats& stats, const ViewSettings& settings) {
  return {stats.gpu_ms, scalingMs(stats), stats.variance, stats.accumulated > settings.samples};
}

Controller::Controller(const PriceList& prices, const Goal& goal) : prices_(prices), goal_(goal), patience_(kPatience) {
  for (size_t rung = 0; rung < kRungs; ++rung) price_ms_[rung] = prices.rungs[rung].scaling_ms;
  if (goal.kind == Goal::Kind::max_error) {
    decision_.rung = quickestWithin(goal.value);
    why_ = fmt::format("{} is what the price list says of {:.3g}", nameOf(decision_.rung), goal.value);
  } else {
    why_ = fmt::format("{} is the quickest, until times are known", nameOf(0));
  }
  describe();
}

void Controller::observe(const Observation& frame) {
  ++frames_here_;
  still_ = frame.still;
  const double scaling = std::clamp(frame.scaling_ms, 0.0, frame.gpu_ms);
  keep(loads_, {frame.gpu_ms - scaling, scaling / price_ms_[decision_.rung]}, kWindow);
  if (frames_here_ == kSettling) learnPrice();
  if (frame.variance) keep(variances_, prices_.variance(decision_.rung, *frame.variance), kVariances);
  // From here on what was measured on this rung says more than what another one foretold.
  if (frames_here_ == kSettling && variances_.size() > kSettling)
    variances_.erase(variances_.begin(), variances_.end() - kSettling);
  if (goal_.kind == Goal::Kind::max_frame_ms) {
    keep(late_, frame.gpu_ms > goal_.value, kLateOf);
    followTime();
  } else if (frames_here_ >= kSettling && !variances_.empty()) {
    followError();
  }
  describe();
}

double Controller::predictedMs(size_t rung, size_t frames, double quantile) const {
  if (loads_.empty()) return 0.0;
  std::vector<double> times;
  for (size_t i = loads_.size() - std::min(frames, loads_.size()); i < loads_.size(); ++i)
    times.push_back(loads_[i].fixed_ms + loads_[i].unit_ms * price_ms_[rung]);
  const auto at = times.begin() + std::lround(quantile * static_cast<double>(times.size() - 1));
  std::nth_element(times.begin(), at, times.end());
  return *at;
}

/// Before the first frame: by the price list alone.
double Controller::predictedError(size_t rung) const {
  const Price& price = prices_.rungs[rung];
  if (variances_.empty()) return price.variance + price.bias;
  return medianOf(variances_) * price.variance / prices_.rungs[decision_.rung].variance + price.bias;
}

/// The best, if none is.
size_t Controller::quickestWithin(double error) const {
  size_t best = 0;
  for (size_t rung = 0; rung < kRungs; ++rung) {
    if (predictedError(rung) <= error) return rung;
    if (predictedError(rung) < predictedError(best)) best = rung;
  }
  return best;
}

bool Controller::mayTry() const { return frames_here_ >= patience_; }

void Controller::followTime() {
  const size_t rung = decision_.rung;
  const auto late = static_cast<size_t>(std::count(late_.begin(), late_.end(), true));
  if (late >= kLate && rung > 0) {
    size_t to = rung - 1;
    while (to > 0 && predictedMs(to, kRecent, 1.0) > kComfort * goal_.value) --to;
    moveTo(to, false,
           fmt::format("{}: on {}, {} of {} frames took more than {:.4g} ms", nameOf(to), nameOf(rung), late,
                       late_.size(), goal_.value));
  } else if (late == 0 && rung + 1 < kRungs && mayTry()) {
    if (const double ms = predictedMs(rung + 1, kWindow, 0.95); ms <= kRoom * goal_.value)
      moveTo(rung + 1, true,
             fmt::format("{}: 95 of 100 frames should take no more than {:.4g} of {:.4g} ms", nameOf(rung + 1), ms,
                         goal_.value));
  }
}

void Controller::followError() {
  const size_t rung = decision_.rung;
  const double error = predictedError(rung);
  if (error > goal_.value) {
    const size_t to = quickestWithin(kRoom * goal_.value);
    if (to > rung && frames_here_ >= (still_ ? kSettlingStill : kSettling))
      moveTo(
          to, false,
          fmt::format("{}: {} has an error of {:.3g}, more than {:.3g}", nameOf(to), nameOf(rung), error, goal_.value));
  } else if (!still_ && mayTry()) {
    if (const size_t to = quickestWithin(kWellWithin * goal_.value); to < rung) {
      const double then = predictedError(to);
      if (then > kWellWithin * goal_.value) return;  // the best of none
      moveTo(to, true, fmt::format("{}: an error of {:.3g} of {:.3g} is enough", nameOf(to), then, goal_.value));
    }
  }
}

/// A rung's price by what changed when it was stepped on: half of it, since the picture changes too.
void Controller::learnPrice() {
  if (loads_.size() < 2 * kSettling) return;
  std::vector<double> before, after;
  for (size_t i = 0; i < kSettling; ++i) {
    before.push_back(loads_[loads_.size() - 2 * kSettling + i].unit_ms);
    after.push_back(loads_[loads_.size() - kSettling + i].unit_ms);
  }
  const double ratio = median(after) / median(before);
  if (!(ratio > 1.0 / kMostCorrection && ratio < kMostCorrection)) return;
  const double correction = std::sqrt(ratio);
  price_ms_[decision_.rung] *= correction;
  for (size_t i = 0; i < kSettling; ++i) loads_[loads_.size() - kSettling + i].unit_ms /= correction;
}

void Controller::moveTo(size_t rung, bool a_try, const std::string& why) {
  if (!a_try && trying_ && frames_here_ < 2 * patience_) patience_ = std::min(2 * patience_, kMostPatience);
  else if (frames_here_ > 8 * patience_) patience_ = std::max(kPatience, patience_ / 2);
  trying_ = a_try;
  for (double& variance : variances_) variance *= prices_.rungs[rung].variance / prices_.rungs[decision_.rung].variance;
  decision_.rung = rung;
  why_ = why;
  late_.clear();
  frames_here_ = 0;
}

/// What is said of the next frame.
void Controller::describe() {
  const size_t rung = decision_.rung;
  decision_.predicted_ms = predictedMs(rung, kWindow, 0.5);
  decision_.predicted_error = predictedError(rung);
  decision_.reason = why_;
  if (goal_.kind == Goal::Kind::max_frame_ms) {
    const double least = predictedMs(0, kRecent, 0.5);
    decision_.within_reach = least <= goal_.value;
    if (!decision_.within_reach)
      decision_.reason =
          fmt::format("{}: even the quickest takes {:.4g} of {:.4g} ms", nameOf(rung), least, goal_.value);
  } else {
    const double least = predictedError(quickestWithin(0.0));
    decision_.within_reach = least <= goal_.value;
    if (!decision_.within_reach)
      decision_.reason =
          fmt::format("{}: even the best has an error of {:.3g}, more than {:.3g}", nameOf(rung), least, goal_.value);
  }
}

}  // namespace helio::render
