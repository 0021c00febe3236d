// Hard cases: every sample finite, no more light than there is, and the truth where it is known.
#include <gmock/gmock.h>

#include "hard/trial.h"
#include "support/stage.h"

namespace helio::test {
namespace {

struct HardTest : testing::TestWithParam<std::pair<const HardCase*, size_t>> {};

TEST_P(HardTest, HoldsInEveryMode) {
  const auto& [hard, value] = GetParam();
  const HardScene scene = hard->make(hard->values[value]);
  for (const Way& way : kWays) {
    const auto measured = measure(renderer(), scene, way, false);
    ASSERT_TRUE(measured) << measured.error().message;
    EXPECT_THAT(broken(scene, *measured, false), testing::IsEmpty())
        << hard->name << ", " << hard->values[value] << " " << hard->parameter << ", " << way.name;
  }
}

std::vector<std::pair<const HardCase*, size_t>> all() {
  std::vector<std::pair<const HardCase*, size_t>> list;
  for (const HardCase& hard : hardCases())
    for (size_t i = 0; i < hard.values.size(); ++i) list.emplace_back(&hard, i);
  return list;
}

INSTANTIATE_TEST_SUITE_P(Hard, HardTest, testing::ValuesIn(all()), [](const auto& info) {
  return info.param.first->name + "_" + std::to_string(info.param.second + 1);
});

}  // namespace
}  // namespace helio::test
