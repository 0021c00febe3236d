// Chooses, frame by frame, the rung of the ladder that a viewer's goal asks for.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "render/ladder.h"

namespace helio::render {

struct Goal {
  enum class Kind {
    max_frame_ms,  ///< the best picture of which 95 frames of 100 take no longer on the GPU; milliseconds, (0, 10000]
    max_error,     ///< the quickest picture whose relative mean square error is believed no greater, (0, 10]
  };
  Kind kind = Kind::max_frame_ms;
  double value = 0.0;
  bool operator==(const Goal&) const = default;
};
Result<void> check(const Goal& goal);

/// A frame's figures: all that decisions depend on. Whoever has a session's observations can replay it.
struct Observation {
  double gpu_ms = 0.0;
  double scaling_ms = 0.0;         ///< of that, what grows with the rung
  std::optional<double> variance;  ///< as the denoiser believes
  bool still = false;              ///< the picture stood still: it gets better by itself
  bool operator==(const Observation&) const = default;
};
/// `settings`: what it was rendered with.
Observation observe(const FrameStats& stats, const ViewSettings& settings);

struct Decision {
  size_t rung = 0;
  double predicted_ms = 0.0;     ///< 0: nothing was measured yet
  double predicted_error = 0.0;  ///< by the price list alone, until a frame was measured
  bool within_reach = true;      ///< false: no rung reaches the goal, and this one comes nearest
  std::string reason;            ///< one line for people: why this rung
};

/// A pure function of the price list, the goal and the observations so far.
///
/// Times: a frame takes what is the same on all rungs, and the rest by the ratio of prices. The controller steps down
/// when two of the last twenty frames were late, and up, one rung at a time, when nearly all of the last frames would
/// have fitted on the next rung with room to spare. What a step really changed corrects the prices.
///
/// Errors: a frame's is the variance that the denoiser believes, made comparable by the prices, and the rung's bias.
/// The controller steps up when the median of the last frames is beyond the goal, and down when a quicker rung would be
/// well within it; not while the picture stands still, since that would begin it again.
///
/// A step towards the better that had to be taken back doubles the time until the next try: it does not oscillate.
class Controller {
 public:
  /// `prices` outlives it.
  Controller(const PriceList& prices, const Goal& goal);

  /// For the next frame.
  const Decision& decision() const { return decision_; }
  const Goal& goal() const { return goal_; }
  /// A frame that was rendered as decision() says.
  void observe(const Observation& frame);

 private:
  /// A frame's time, apart from the rung that it was rendered on.
  struct Load {
    double fixed_ms;
    double unit_ms;  // what scales, over the rung's price
  };
  /// The quantile of what `rung` would have taken over the last `frames`; 0 before the first.
  double predictedMs(size_t rung, size_t frames, double quantile) const;
  double predictedError(size_t rung) const;
  size_t quickestWithin(double error) const;
  bool mayTry() const;
  void followTime();
  void followError();
  void learnPrice();
  void moveTo(size_t rung, bool a_try, const std::string& why);
  void describe();

  const PriceList& prices_;
  const Goal goal_;
  std::array<double, kRungs> price_ms_;  // corrected by what steps really changed
  Decision decision_;
  std::string why_;               // of the last step
  std::deque<Load> loads_;        // of the last frames, the newest last
  std::deque<bool> late_;         // frames on this rung that took longer than the goal
  std::deque<double> variances_;  // of the last frames, as on this rung
  uint32_t frames_here_ = 0;      // on this rung
  uint32_t patience_;             // frames on a rung until a step towards the better is tried
  bool trying_ = false;           // the last step was such a try
  bool still_ = false;
};

}  // namespace helio::render
