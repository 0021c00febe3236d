// What every EditLog backend must do. A backend's test file names its factory:
//
//   INSTANTIATE_TEST_SUITE_P(Memory, EditLogConformance, ::testing::Values(Backend{"Memory", makeMemoryEditLog}));
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include "store/edit_log.h"

namespace helio::store {

struct Backend {
  std::string name;
  std::function<std::unique_ptr<EditLog>()> make;  ///< a new, empty log
};

inline std::ostream& operator<<(std::ostream& out, const Backend& backend) { return out << backend.name; }

class EditLogConformance : public ::testing::TestWithParam<Backend> {
 protected:
  uint64_t acquire(const std::string& world = "w") {
    const Result<uint64_t> epoch = log_->acquire(world);
    EXPECT_TRUE(epoch.ok());
    return epoch.ok() ? *epoch : 0;
  }
  /// Appends records first..last with request ids "r<seq>" and bytes "b<seq>".
  void fill(const std::string& world, uint64_t epoch, uint64_t first, uint64_t last) {
    for (uint64_t seq = first; seq <= last; ++seq) ASSERT_EQ(log_->append(world, epoch, record(seq)), Append::ok);
  }
  static Record record(uint64_t seq) { return {seq, fmt::format("r{}", seq), fmt::format("b{}", seq)}; }
  std::vector<uint64_t> seqs(const std::string& world, uint64_t after = 0, size_t limit = SIZE_MAX) const {
    const Result<std::vector<Record>> records = log_->read(world, after, limit);
    EXPECT_TRUE(records.ok());
    std::vector<uint64_t> seqs;
    if (records) {
      for (const Record& record : *records) seqs.push_back(record.seq);
    }
    return seqs;
  }

  std::unique_ptr<EditLog> log_ = GetParam().make();
};

}  // namespace helio::store
