// A picture that accumulates for days: after 10^6 samples the mean is within 10^-4 [correctness: hard cases].
#include <gtest/gtest.h>

#include "probe.h"

namespace helio::test {
namespace {

using shared::AccumulationAnswer;
using shared::AccumulationQuestion;

TEST(Accumulation, AMillionSamplesStillCount) {
  constexpr uint32_t kCount = 1'000'000, kRuns = 16;
  for (const uint32_t kind : {shared::kAccumulateConstant, shared::kAccumulateNoise, shared::kAccumulateSpikes,
                              shared::kAccumulateDarkening}) {
    std::vector<AccumulationQuestion> questions;
    for (uint32_t seed = 0; seed < kRuns; ++seed) questions.push_back({kCount, kind, seed});
    for (const AccumulationAnswer& answer :
         probe().ask<AccumulationAnswer, AccumulationQuestion>("accumulate_many.comp", {}, questions)) {
      const double truth = static_cast<double>(answer.sum) / shared::kAccumulationUnit / kCount;
      EXPECT_EQ(answer.samples, static_cast<float>(kCount));
      EXPECT_NEAR(static_cast<double>(answer.mean), truth, 1e-4 * truth) << "kind " << kind;
    }
  }
}

}  // namespace
}  // namespace helio::test
