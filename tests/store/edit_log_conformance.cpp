#include "edit_log_conformance.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace helio::store {
namespace {

/// Collects a watch's records. A backend may call back later than append() returns: waitFor() waits, for half a minute
/// at most, and says whether that many came.
class Listener {
 public:
  std::function<void(const Record&)> callback() {
    return [this](const Record& record) {
      const std::lock_guard lock(mutex_);
      records_.push_back(record);
      came_.notify_all();
    };
  }
  bool waitFor(size_t count) {
    std::unique_lock lock(mutex_);
    return came_.wait_for(lock, std::chrono::seconds(30), [&] { return records_.size() >= count; });
  }
  std::vector<Record> records() const {
    const std::lock_guard lock(mutex_);
    return records_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable came_;
  std::vector<Record> records_;
};

TEST_P(EditLogConformance, ReadsBackWhatWasAppendedInOrder) {
  const uint64_t epoch = acquire();
  const std::string binary("\0\xff\n\0", 4);
  ASSERT_EQ(log_->append("w", epoch, {1, "one", binary}), Append::ok);
  ASSERT_EQ(log_->append("w", epoch, {2, "two", ""}), Append::ok);
  const Result<std::vector<Record>> records = log_->read("w", 0, 10);
  ASSERT_TRUE(records.ok());
  ASSERT_EQ(records->size(), 2u);
  EXPECT_EQ((*records)[0].seq, 1u);
  EXPECT_EQ((*records)[0].request_id, "one");
  EXPECT_EQ((*records)[0].bytes, binary);
  EXPECT_EQ((*records)[1].seq, 2u);
  EXPECT_EQ((*records)[1].bytes, "");
}

TEST_P(EditLogConformance, ReadsInPages) {
  fill("w", acquire(), 1, 5);
  EXPECT_THAT(seqs("w", 0, 2), ::testing::ElementsAre(1, 2));
  EXPECT_THAT(seqs("w", 2, 2), ::testing::ElementsAre(3, 4));
  EXPECT_THAT(seqs("w", 4, 2), ::testing::ElementsAre(5));
  EXPECT_THAT(seqs("w", 5, 2), ::testing::IsEmpty());
  EXPECT_THAT(seqs("w", UINT64_MAX, SIZE_MAX), ::testing::IsEmpty());
  EXPECT_THAT(seqs("w", 0, 0), ::testing::IsEmpty());
}

TEST_P(EditLogConformance, RefusesAnyOtherSequenceNumber) {
  const uint64_t epoch = acquire();
  for (uint64_t seq : {uint64_t{0}, uint64_t{2}, UINT64_MAX})
    EXPECT_EQ(log_->append("w", epoch, record(seq)), Append::out_of_order);
  fill("w", epoch, 1, 2);
  for (uint64_t seq : {uint64_t{0}, uint64_t{1}, uint64_t{2}, uint64_t{4}}) {
    EXPECT_EQ(log_->append("w", epoch, {seq, "new", "x"}), Append::out_of_order) << seq;
  }
  EXPECT_EQ(log_->find("w", "new"), std::nullopt);
  EXPECT_THAT(seqs("w"), ::testing::ElementsAre(1, 2));
}

TEST_P(EditLogConformance, ARepeatedRequestAnswersOkAndChangesNothing) {
  const uint64_t epoch = acquire();
  fill("w", epoch, 1, 2);
  EXPECT_EQ(log_->append("w", epoch, record(1)), Append::ok);
  EXPECT_EQ(log_->append("w", epoch, {3, "r2", "other bytes"}), Append::ok);  // resent under the seq that comes next
  EXPECT_THAT(seqs("w"), ::testing::ElementsAre(1, 2));
  EXPECT_EQ(log_->find("w", "r2"), 2u);
  EXPECT_EQ((*log_->read("w", 1, 1))[0].bytes, "b2");
  EXPECT_EQ(log_->append("w", epoch, record(3)), Append::ok);
}

TEST_P(EditLogConformance, EmptyRequestIdsAreNeverTheSame) {
  const uint64_t epoch = acquire();
  EXPECT_EQ(log_->append("w", epoch, {1, "", "a"}), Append::ok);
  EXPECT_EQ(log_->append("w", epoch, {2, "", "b"}), Append::ok);
  EXPECT_THAT(seqs("w"), ::testing::ElementsAre(1, 2));
  EXPECT_EQ(log_->find("w", ""), std::nullopt);
}

TEST_P(EditLogConformance, FindsRequestsOfTheirWorldOnly) {
  fill("w", acquire("w"), 1, 2);
  acquire("v");
  EXPECT_EQ(log_->find("w", "r2"), 2u);
  EXPECT_EQ(log_->find("w", "r3"), std::nullopt);
  EXPECT_EQ(log_->find("v", "r2"), std::nullopt);
  EXPECT_EQ(log_->find("nowhere", "r2"), std::nullopt);
}

TEST_P(EditLogConformance, AcquiringFencesEarlierEpochs) {
  const uint64_t first = acquire();
  fill("w", first, 1, 1);
  const uint64_t second = acquire();
  EXPECT_GT(second, first);
  EXPECT_EQ(log_->append("w", first, record(2)), Append::fenced);
  EXPECT_EQ(log_->append("w", first, record(1)),
            Append::fenced);  // even a repeat: who is fenced may not speak for the world
  EXPECT_EQ(log_->append("w", second + 1, record(2)), Append::fenced);  // an epoch that nobody was given
  EXPECT_THAT(seqs("w"), ::testing::ElementsAre(1));
  EXPECT_EQ(log_->append("w", second, record(1)), Append::ok);  // the request ids came along
  EXPECT_EQ(log_->append("w", second, record(2)), Append::ok);
  EXPECT_THAT(seqs("w"), ::testing::ElementsAre(1, 2));
}

TEST_P(EditLogConformance, WorldsDoNotTouchEachOther) {
  const uint64_t a = acquire("a"), b = acquire("b");
  fill("a", a, 1, 3);
  fill("b", b, 1, 1);
  acquire("b");
  EXPECT_EQ(log_->append("a", a, record(4)), Append::ok);
  EXPECT_THAT(seqs("a"), ::testing::ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(seqs("b"), ::testing::ElementsAre(1));
}

TEST_P(EditLogConformance, NamesWorldsThatDoNotExist) {
  EXPECT_EQ(log_->append("nowhere", 1, record(1)), Append::fenced);
  const Result<std::vector<Record>> records = log_->read("nowhere", 0, 1);
  ASSERT_FALSE(records.ok());
  EXPECT_EQ(records.error().kind, ErrorKind::not_found);
  EXPECT_THAT(records.error().message, ::testing::HasSubstr("\"nowhere\""));
  EXPECT_EQ(log_->snapshot("nowhere").error().kind, ErrorKind::not_found);
  EXPECT_EQ(log_->remove("nowhere").error().kind, ErrorKind::not_found);
  EXPECT_EQ(log_->putSnapshot("nowhere", 1, {0, ""}).error().kind, ErrorKind::conflict);
}

TEST_P(EditLogConformance, RemovingForgetsAndFences) {
  const uint64_t old = acquire();
  fill("w", old, 1, 2);
  ASSERT_TRUE(log_->putSnapshot("w", old, {2, "s"}).ok());
  ASSERT_TRUE(log_->remove("w").ok());
  EXPECT_EQ(log_->append("w", old, record(3)), Append::fenced);
  EXPECT_EQ(log_->find("w", "r1"), std::nullopt);
  EXPECT_EQ(log_->read("w", 0, 1).error().kind, ErrorKind::not_found);

  const uint64_t again = acquire();
  EXPECT_GT(again, old);
  EXPECT_EQ(log_->append("w", old, record(1)), Append::fenced);
  EXPECT_THAT(seqs("w"), ::testing::IsEmpty());
  EXPECT_FALSE(log_->snapshot("w")->has_value());
  EXPECT_EQ(log_->append("w", again, record(1)), Append::ok);
}

TEST_P(EditLogConformance, KeepsTheNewestSnapshot) {
  const uint64_t epoch = acquire();
  EXPECT_FALSE(log_->snapshot("w")->has_value());
  fill("w", epoch, 1, 4);
  ASSERT_TRUE(log_->putSnapshot("w", epoch, {2, "two"}).ok());
  ASSERT_TRUE(log_->putSnapshot("w", epoch, {3, "three"}).ok());
  ASSERT_TRUE(log_->putSnapshot("w", epoch, {3, "three again"}).ok());
  EXPECT_EQ(log_->putSnapshot("w", epoch, {2, "back"}).error().kind, ErrorKind::invalid);
  EXPECT_EQ(log_->putSnapshot("w", epoch, {5, "ahead"}).error().kind, ErrorKind::invalid);

  const Result<std::optional<Snapshot>> snapshot = log_->snapshot("w");
  ASSERT_TRUE(snapshot.ok() && snapshot->has_value());
  EXPECT_EQ((*snapshot)->seq, 3u);
  EXPECT_EQ((*snapshot)->bytes, "three again");
  EXPECT_THAT(seqs("w", 3), ::testing::ElementsAre(4));  // what a restart replays
  EXPECT_EQ(log_->find("w", "r1"), 1u);
}

TEST_P(EditLogConformance, AFencedSnapshotIsRefused) {
  const uint64_t first = acquire();
  fill("w", first, 1, 2);
  ASSERT_TRUE(log_->putSnapshot("w", first, {1, "one"}).ok());
  acquire();
  const Result<void> put = log_->putSnapshot("w", first, {2, "two"});
  ASSERT_FALSE(put.ok());
  EXPECT_EQ(put.error().kind, ErrorKind::conflict);
  EXPECT_EQ((*log_->snapshot("w"))->bytes, "one");
}

TEST_P(EditLogConformance, TruncatingForgetsRecordsAndKeepsReceipts) {
  const uint64_t epoch = acquire();
  for (uint64_t seq = 1; seq <= 6; ++seq)
    ASSERT_EQ(log_->append("w", epoch, {seq, fmt::format("r{}", seq), "bytes", fmt::format("receipt {}", seq)}),
              Append::ok);
  EXPECT_EQ(log_->truncate("w", epoch, 1).error().kind, ErrorKind::invalid);  // there is no snapshot
  ASSERT_TRUE(log_->putSnapshot("w", epoch, {4, "four"}).ok());
  EXPECT_EQ(log_->truncate("w", epoch, 5).error().kind, ErrorKind::invalid);
  EXPECT_EQ(log_->truncate("w", epoch + 1, 4).error().kind, ErrorKind::conflict);
  EXPECT_THAT(seqs("w"), ::testing::ElementsAre(1, 2, 3, 4, 5, 6));

  ASSERT_TRUE(log_->truncate("w", epoch, 3).ok());
  ASSERT_TRUE(log_->truncate("w", epoch, 2).ok());  // they are forgotten already
  EXPECT_THAT(seqs("w", 3), ::testing::ElementsAre(4, 5, 6));
  EXPECT_THAT(seqs("w", 4, 1), ::testing::ElementsAre(5));
  EXPECT_EQ(log_->read("w", 2, 1).error().kind, ErrorKind::conflict);  // no gap goes unnoticed
  EXPECT_EQ((*log_->receipt("w", "r2"))->seq, 2u);
  EXPECT_EQ((*log_->receipt("w", "r2"))->bytes, "receipt 2");
  EXPECT_EQ(log_->append("w", epoch, {7, "r2", "again", ""}), Append::ok);
  EXPECT_EQ((*log_->receipt("w", "r2"))->bytes, "receipt 2");
  EXPECT_EQ(log_->append("w", epoch, record(7)), Append::ok);
  EXPECT_THAT(seqs("w", 3), ::testing::ElementsAre(4, 5, 6, 7));
}

TEST_P(EditLogConformance, KnowsItsWorldsAndTheirManifests) {
  EXPECT_THAT(*log_->worlds(), ::testing::IsEmpty());
  const uint64_t first = acquire("b");
  acquire("a");
  acquire("c");
  EXPECT_THAT(*log_->worlds(), ::testing::ElementsAre("a", "b", "c"));
  EXPECT_EQ(*log_->manifest("b"), "");
  ASSERT_TRUE(log_->putManifest("b", first, "a village").ok());
  EXPECT_EQ(*log_->manifest("b"), "a village");
  EXPECT_EQ(*log_->manifest("a"), "");
  const uint64_t second = acquire("b");
  EXPECT_EQ(log_->putManifest("b", first, "late").error().kind, ErrorKind::conflict);
  ASSERT_TRUE(log_->putManifest("b", second, "a town").ok());
  EXPECT_EQ(*log_->manifest("b"), "a town");
  EXPECT_EQ(log_->manifest("nowhere").error().kind, ErrorKind::not_found);

  ASSERT_TRUE(log_->remove("b").ok());
  EXPECT_THAT(*log_->worlds(), ::testing::ElementsAre("a", "c"));
  acquire("b");
  EXPECT_EQ(*log_->manifest("b"), "");
}

TEST_P(EditLogConformance, WatchersSeeEveryLaterRecordInOrder) {
  Listener early, late;
  const auto early_handle = log_->watch("w", early.callback());  // before the world exists
  const uint64_t epoch = acquire();
  fill("w", epoch, 1, 3);
  const auto late_handle = log_->watch("w", late.callback());
  fill("w", epoch, 4, 6);
  log_->append("w", epoch, record(6));       // neither a repeat
  log_->append("w", epoch, {9, "gap", ""});  // nor what was refused is told
  const uint64_t other = acquire("other");
  fill("other", other, 1, 1);  // nor another world's
  fill("w", epoch, 7, 7);

  ASSERT_TRUE(early.waitFor(7) && late.waitFor(4));
  const std::vector<Record> told = early.records(), told_late = late.records();
  ASSERT_EQ(told.size(), 7u);
  ASSERT_EQ(told_late.size(), 4u);
  for (uint64_t i = 0; i < 7; ++i) {
    EXPECT_EQ(told[i].seq, i + 1);
    EXPECT_EQ(told[i].request_id, record(i + 1).request_id);
    EXPECT_EQ(told[i].bytes, record(i + 1).bytes);
  }
  for (uint64_t i = 0; i < 4; ++i) EXPECT_EQ(told_late[i].seq, i + 4);
}

TEST_P(EditLogConformance, NoCallComesAfterTheHandleEnded) {
  Listener gone, staying;
  auto handle = log_->watch("w", gone.callback());
  const auto other = log_->watch("w", staying.callback());
  const uint64_t epoch = acquire();
  fill("w", epoch, 1, 2);
  ASSERT_TRUE(gone.waitFor(2));
  handle.reset();
  fill("w", epoch, 3, 4);
  ASSERT_TRUE(staying.waitFor(4));
  EXPECT_EQ(gone.records().size(), 2u);
}

TEST_P(EditLogConformance, HandlesMayOutliveTheLog) {
  Listener listener;
  auto handle = log_->watch("w", listener.callback());
  log_.reset();
  handle.reset();
  EXPECT_TRUE(listener.records().empty());
}

TEST_P(EditLogConformance, CallbacksMayUseTheLogAndDropTheirHandle) {
  const uint64_t epoch = acquire();
  Listener chained;
  const auto chained_handle = log_->watch("w", chained.callback());
  std::shared_ptr<void> handle;
  std::atomic<int> calls = 0;
  handle = log_->watch("w", [&](const Record& record) {
    ++calls;
    EXPECT_EQ(log_->find("w", record.request_id), record.seq);
    EXPECT_EQ(log_->append("w", epoch, EditLogConformance::record(record.seq + 1)), Append::ok);
    if (record.seq == 3) handle.reset();
  });
  ASSERT_EQ(log_->append("w", epoch, record(1)), Append::ok);
  ASSERT_TRUE(chained.waitFor(4));  // 1 from here, 2 to 4 each from the call before
  EXPECT_EQ(calls, 3);
  const std::vector<Record> told = chained.records();
  for (uint64_t i = 0; i < told.size(); ++i) EXPECT_EQ(told[i].seq, i + 1);
}

TEST_P(EditLogConformance, WritersThatRaceLoseNothingAndDoubleNothing) {
  constexpr int kWriters = 4, kRequests = 100;
  const uint64_t epoch = acquire();
  Listener listener;
  const auto handle = log_->watch("w", listener.callback());
  std::vector<std::thread> writers;
  for (int writer = 0; writer < kWriters; ++writer) {
    writers.emplace_back([&, writer] {
      uint64_t seq = 1;
      for (int i = 0; i < kRequests; ++i) {
        // Two writers share every request id: one of them must find it done.
        const std::string request = fmt::format("{}/{}", writer / 2, i);
        Append answer;
        while ((answer = log_->append("w", epoch, {seq, request, request})) != Append::ok) {
          ASSERT_TRUE(answer == Append::out_of_order || answer == Append::unknown);
          const auto tail = log_->read("w", seq - 1, SIZE_MAX);
          ASSERT_TRUE(tail.ok());
          seq += tail->size();
        }
      }
    });
  }
  for (std::thread& writer : writers) writer.join();

  constexpr size_t kRecords = size_t{kWriters} / 2 * kRequests;
  const Result<std::vector<Record>> records = log_->read("w", 0, SIZE_MAX);
  ASSERT_TRUE(records.ok());
  ASSERT_EQ(records->size(), kRecords);
  for (size_t i = 0; i < kRecords; ++i) {
    EXPECT_EQ((*records)[i].seq, i + 1);
    EXPECT_EQ(log_->find("w", (*records)[i].request_id), i + 1);
  }
  ASSERT_TRUE(listener.waitFor(kRecords));
  const std::vector<Record> told = listener.records();
  ASSERT_EQ(told.size(), kRecords);
  for (size_t i = 0; i < kRecords; ++i) EXPECT_EQ(told[i].seq, i + 1);
}

TEST_P(EditLogConformance, ServersThatFightOverAWorldNeverBothWrite) {
  constexpr int kServers = 3, kTakeOvers = 50;
  std::vector<std::thread> servers;
  for (int server = 0; server < kServers; ++server) {
    servers.emplace_back([&, server] {
      for (int i = 0; i < kTakeOvers; ++i) {
        const Result<uint64_t> epoch = log_->acquire("w");
        ASSERT_TRUE(epoch.ok());
        const uint64_t last = log_->read("w", 0, SIZE_MAX)->size();
        const std::string request = fmt::format("{}/{}", server, i);
        const Append answer = log_->append("w", *epoch, {last + 1, request, std::to_string(*epoch)});
        // Nobody else can have written under an epoch that is still ours, so the sequence number always fits; one that
        // is not may have been taken over before or after our read.
        EXPECT_TRUE(answer == Append::ok || answer == Append::fenced);
        EXPECT_EQ(log_->find("w", request).has_value(), answer == Append::ok);
      }
    });
  }
  for (std::thread& server : servers) server.join();
  uint64_t last_epoch = 0;
  const Result<std::vector<Record>> records = log_->read("w", 0, SIZE_MAX);
  ASSERT_TRUE(records.ok());
  for (const Record& record : *records) {
    const uint64_t epoch = std::stoull(record.bytes);
    EXPECT_GT(epoch, last_epoch);  // epochs never go back: a fenced server did not get through
    last_epoch = epoch;
  }
}

TEST_P(EditLogConformance, WhatIsNotDamagedIsNotRepaired) {
  EXPECT_EQ(log_->repair("w", 0).error().kind, ErrorKind::not_found);
  const uint64_t epoch = acquire();
  fill("w", epoch, 1, 3);
  const auto repair = log_->repair("w", 100);
  ASSERT_TRUE(repair.ok()) << repair.error().message;
  EXPECT_EQ(repair->last_seq, 3u);
  EXPECT_EQ(repair->lost, 0u);
  EXPECT_EQ(repair->forgotten_requests, 0u);
  EXPECT_EQ(seqs("w"), (std::vector<uint64_t>{1, 2, 3}));
  EXPECT_EQ(log_->append("w", epoch, record(4)), Append::ok) << "who has the world keeps it";
}

}  // namespace
}  // namespace helio::store
