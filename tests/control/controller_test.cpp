// The controller against a simulated plant: frames whose time and error are known functions of the rung.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "render/controller.h"

namespace helio::test {
namespace {

using render::Controller;
using render::Goal;
using render::kLadder;
using render::kRungs;
using render::Observation;

/// Prices that rise by half and errors that fall by a third a rung.
render::PriceList prices() {
  render::PriceList list;
  list.source = "a test's";
  for (size_t rung = 0; rung < kRungs; ++rung) {
    const auto r = static_cast<double>(rung);
    list.rungs[rung] = {std::pow(1.5, r), 0.02 * std::pow(0.7, r), 0.01 * std::pow(0.7, r), 0.02 * std::pow(0.6, r)};
  }
  return list;
}

/// What frames cost and how noisy they are.
struct Plant {
  double fixed_ms = 3.0, unit_ms = 2.0;
  double variance = 1.0;             ///< times the list's
  std::array<double, kRungs> truth;  ///< of each rung's price: what the list has wrong
  double jitter = 0.05;              ///< standard deviation of a frame's time, of 1
  double spikes = 0.0;               ///< share of frames that take twice as long
  std::mt19937 random{7};

  Plant() { truth.fill(1.0); }

  Observation frame(const render::PriceList& list, size_t rung) {
    std::normal_distribution<double> noise(1.0, jitter);
    std::bernoulli_distribution spike(spikes);
    const double factor = std::max(0.1, noise(random)) * (spike(random) ? 2.0 : 1.0);
    const double scaling = unit_ms * list.rungs[rung].scaling_ms * truth[rung] * factor;
    return {fixed_ms + scaling, scaling, variance * list.rungs[rung].estimated * std::max(0.1, noise(random)), false};
  }
};

struct Session {
  std::vector<size_t> rungs;
  std::vector<double> ms;

  size_t moves(size_t from = 0) const {
    size_t count = 0;
    for (size_t i = from + 1; i < rungs.size(); ++i) count += rungs[i] != rungs[i - 1];
    return count;
  }
  double shareWithin(double goal, size_t from = 0) const {
    const auto within =
        std::count_if(ms.begin() + static_cast<std::ptrdiff_t>(from), ms.end(), [&](double v) { return v <= goal; });
    return static_cast<double>(within) / static_cast<double>(ms.size() - from);
  }
};

/// `before_each` may change the plant.
Session run(Controller& controller, const render::PriceList& list, Plant& plant, size_t frames,
            const std::function<void(size_t)>& before_each = {}) {
  Session session;
  for (size_t i = 0; i < frames; ++i) {
    if (before_each) before_each(i);
    session.rungs.push_back(controller.decision().rung);
    const Observation frame = plant.frame(list, controller.decision().rung);
    session.ms.push_back(frame.gpu_ms);
    controller.observe(frame);
  }
  return session;
}

TEST(Ladder, IsClimbedFromTheQuickestAndItsSettingsAreTheRungs) {
  render::ViewSettings wanted;
  wanted.width = 333;
  wanted.regularisation = 0.25f;
  for (size_t rung = 0; rung < kRungs; ++rung) {
    const render::ViewSettings settings = render::onRung(wanted, rung);
    EXPECT_TRUE(render::check(settings).ok()) << kLadder[rung].name;
    EXPECT_EQ(render::nearestRung(settings), rung) << "a rung's own prices are the nearest";
    EXPECT_EQ(settings.width, 333u);
    EXPECT_EQ(settings.regularisation, 0.25f);
    EXPECT_NE(settings.denoiser, render::Denoiser::none);
    if (rung > 0) {
      EXPECT_GE(uint64_t{kLadder[rung].samples} * (kLadder[rung].bounces + 1),
                uint64_t{kLadder[rung - 1].samples} * (kLadder[rung - 1].bounces + 1));
    }
  }
  wanted.denoiser = render::Denoiser::asvgf;
  EXPECT_EQ(render::onRung(wanted, 0).denoiser, render::Denoiser::asvgf) << "a viewer's own choice stays";
}

TEST(Ladder, ThePriceListOfTheProgramIsUsable) {
  const render::PriceList& list = render::usualPrices();
  EXPECT_FALSE(list.source.empty());
  for (size_t rung = 0; rung < kRungs; ++rung) {
    const render::Price& price = list.rungs[rung];
    EXPECT_GT(price.scaling_ms, rung > 0 ? list.rungs[rung - 1].scaling_ms : 0.0) << kLadder[rung].name;
    EXPECT_GT(price.variance, 0.0);
    EXPECT_GT(price.estimated, 0.0);
    EXPECT_GE(price.bias, 0.0);
  }
}

TEST(Controller, KeepsNinetyFiveFramesOfAHundredWithinTheTime) {
  const auto list = prices();
  for (const double goal : {6.0, 8.0, 12.0, 20.0}) {
    SCOPED_TRACE(goal);
    Controller controller(list, {Goal::Kind::max_frame_ms, goal});
    Plant plant;
    const Session session = run(controller, list, plant, 2000);
    EXPECT_GE(session.shareWithin(goal), 0.95);
    // It also uses the time: the next rung would not fit.
    const size_t rung = session.rungs.back();
    EXPECT_TRUE(controller.decision().within_reach);
    if (rung + 1 < kRungs) {
      EXPECT_GT(plant.fixed_ms + plant.unit_ms * list.rungs[rung + 1].scaling_ms * 1.1, 0.9 * goal);
    }
    EXPECT_LE(session.moves(1000), 2u) << "it does not oscillate";
  }
}

TEST(Controller, FollowsALoadThatComesAndGoes) {
  const auto list = prices();
  constexpr double kGoal = 14.0;
  Controller controller(list, {Goal::Kind::max_frame_ms, kGoal});
  Plant plant;
  // The flight leads through something that costs three times as much, over and over.
  const Session session = run(controller, list, plant, 3000, [&](size_t i) {
    const double phase = 6.2831853 * static_cast<double>(i) / 600.0;
    plant.unit_ms = 1.0 + 2.0 * (0.5 - 0.5 * std::cos(phase));
  });
  EXPECT_GE(session.shareWithin(kGoal), 0.95);
  EXPECT_GE(*std::max_element(session.rungs.begin(), session.rungs.end()), 4u) << "with room it goes up";
  EXPECT_LE(*std::min_element(session.rungs.begin() + 200, session.rungs.end()), 3u) << "and down without";
  EXPECT_LE(session.moves(), 60u);
}

TEST(Controller, GoesBackUpWhenThereIsRoomAgain) {
  const auto list = prices();
  Controller controller(list, {Goal::Kind::max_frame_ms, 12.0});
  Plant plant;
  plant.unit_ms = 0.5;
  run(controller, list, plant, 400);
  const size_t before = controller.decision().rung;
  EXPECT_EQ(before, kRungs - 1);
  plant.unit_ms = 6.0;
  const Session burdened = run(controller, list, plant, 200);
  EXPECT_LE(controller.decision().rung, 1u);
  EXPECT_LE(std::count_if(burdened.ms.begin(), burdened.ms.end(), [](double ms) { return ms > 12.0; }), 4)
      << "late frames are answered at once";
  plant.unit_ms = 0.5;
  run(controller, list, plant, 600);
  EXPECT_EQ(controller.decision().rung, before);
}

TEST(Controller, OneLateFrameIsNoReasonToGoDown) {
  const auto list = prices();
  Controller controller(list, {Goal::Kind::max_frame_ms, 12.0});
  Plant plant;
  plant.jitter = 0.0;
  run(controller, list, plant, 200);
  const size_t rung = controller.decision().rung;
  Observation late = plant.frame(list, rung);
  late.gpu_ms += 100.0;
  controller.observe(late);
  EXPECT_EQ(controller.decision().rung, rung);
}

TEST(Controller, LearnsPricesThatTheListHasWrong) {
  const auto list = prices();
  constexpr double kGoal = 10.0;
  Controller controller(list, {Goal::Kind::max_frame_ms, kGoal});
  Plant plant;
  plant.truth = {1.0, 1.3, 1.8, 2.5, 3.0, 3.5};  // samples cost more than the list says
  const Session session = run(controller, list, plant, 4000);
  EXPECT_GE(session.shareWithin(kGoal), 0.95);
  EXPECT_LE(session.moves(2000), 6u) << "tries that failed are repeated more and more rarely";
}

TEST(Controller, SaysWhenNoRungIsQuickEnough) {
  const auto list = prices();
  Controller controller(list, {Goal::Kind::max_frame_ms, 4.0});
  Plant plant;
  plant.fixed_ms = 20.0;
  run(controller, list, plant, 100);
  EXPECT_EQ(controller.decision().rung, 0u);
  EXPECT_FALSE(controller.decision().within_reach);
  EXPECT_NE(controller.decision().reason.find("even the quickest takes"), std::string::npos)
      << controller.decision().reason;
}

TEST(Controller, TakesTheQuickestRungThatIsGoodEnough) {
  const auto list = prices();
  for (const double goal : {0.005, 0.01, 0.02, 0.03}) {
    SCOPED_TRACE(goal);
    Controller controller(list, {Goal::Kind::max_error, goal});
    Plant plant;
    const Session session = run(controller, list, plant, 1000);
    const auto error = [&](size_t rung) { return list.rungs[rung].variance + list.rungs[rung].bias; };
    const size_t rung = session.rungs.back();
    EXPECT_LE(error(rung), 1.05 * goal);
    EXPECT_NEAR(controller.decision().predicted_error, error(rung), 0.2 * error(rung));
    if (rung > 0) { EXPECT_GT(error(rung - 1), 0.7 * goal) << "a quicker one would do"; }
    EXPECT_LE(session.moves(500), 1u);
  }
}

TEST(Controller, AnswersNoiseWithSamplesAndLetsThemGoAgain) {
  const auto list = prices();
  Controller controller(list, {Goal::Kind::max_error, 0.02});
  Plant plant;
  run(controller, list, plant, 300);
  const size_t quiet = controller.decision().rung;
  plant.variance = 4.0;
  run(controller, list, plant, 300);
  const size_t noisy = controller.decision().rung;
  EXPECT_GT(noisy, quiet);
  plant.variance = 0.2;
  run(controller, list, plant, 600);
  EXPECT_LE(controller.decision().rung, quiet);
}

TEST(Controller, SaysWhenNoRungIsGoodEnough) {
  const auto list = prices();
  Controller controller(list, {Goal::Kind::max_error, 1e-5});
  Plant plant;
  run(controller, list, plant, 50);
  EXPECT_EQ(controller.decision().rung, kRungs - 1);
  EXPECT_FALSE(controller.decision().within_reach);
  EXPECT_NE(controller.decision().reason.find("even the best has an error"), std::string::npos)
      << controller.decision().reason;
}

TEST(Controller, LeavesAPictureAloneThatStandsStill) {
  const auto list = prices();
  Controller controller(list, {Goal::Kind::max_error, 0.02});
  Plant plant;
  run(controller, list, plant, 300);
  const size_t rung = controller.decision().rung;
  for (int i = 0; i < 300; ++i) {
    Observation frame = plant.frame(list, rung);
    frame.still = true;
    *frame.variance /= 1.0 + i;  // gets better by itself
    controller.observe(frame);
    ASSERT_EQ(controller.decision().rung, rung) << "a quicker rung would begin it again";
  }
}

TEST(Controller, IsAFunctionOfWhatItObserved) {
  const auto list = prices();
  const Goal goal{Goal::Kind::max_frame_ms, 9.0};
  Plant plant;
  plant.spikes = 0.03;
  plant.jitter = 0.2;
  std::vector<Observation> log;
  std::vector<render::Decision> decisions;
  Controller live(list, goal);
  for (int i = 0; i < 1000; ++i) {
    plant.unit_ms = i % 200 < 100 ? 1.0 : 4.0;
    decisions.push_back(live.decision());
    log.push_back(plant.frame(list, live.decision().rung));
    live.observe(log.back());
  }
  Controller replayed(list, goal);
  size_t moves = 0;
  for (size_t i = 0; i < log.size(); ++i) {
    ASSERT_EQ(replayed.decision().rung, decisions[i].rung) << i;
    ASSERT_EQ(replayed.decision().reason, decisions[i].reason) << i;
    ASSERT_EQ(replayed.decision().predicted_ms, decisions[i].predicted_ms) << i;
    replayed.observe(log[i]);
    moves += i > 0 && decisions[i].rung != decisions[i - 1].rung;
  }
  EXPECT_GT(moves, 2u) << "there was something to decide";
}

TEST(Goals, OutOfRangeAreNamed) {
  using Kind = Goal::Kind;
  for (const Goal bad :
       {Goal{Kind::max_frame_ms, 0.0}, Goal{Kind::max_frame_ms, -1.0}, Goal{Kind::max_frame_ms, 1e5},
        Goal{Kind::max_frame_ms, std::nan("")}, Goal{Kind::max_error, 0.0}, Goal{Kind::max_error, 11.0}}) {
    const auto checked = render::check(bad);
    ASSERT_FALSE(checked.ok()) << bad.value;
    EXPECT_EQ(checked.error().field, bad.kind == Kind::max_error ? "goal.max_error" : "goal.max_frame_ms");
  }
  EXPECT_TRUE(render::check(Goal{Kind::max_frame_ms, 16.6}).ok());
  EXPECT_TRUE(render::check(Goal{Kind::max_error, 0.01}).ok());
}

}  // namespace
}  // namespace helio::test
