// Worlds that outlive their server: what was acknowledged is there again, the same, and what cannot be is said.
#include <sqlite3.h>

#include <atomic>
#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <thread>

#include "fixture.h"
#include "store/sqlite_edit_log.h"

namespace helio::test {
namespace {

using Code = grpc::StatusCode;
using Stub = v1::WorldService::Stub;
namespace fs = std::filesystem;

class DurableTest : public ServiceTest {
 protected:
  DurableTest() {
    server_.reset();
    start();
  }

  fs::path logFolder() const { return folder_ / "log"; }
  void stop() {
    server_.reset();
    log_.reset();
  }
  void start(uint64_t snapshot_bytes = 4 << 20) {
    store::SqliteLogOptions options;
    options.folder = logFolder();
    auto log = store::openSqliteEditLog(std::move(options));
    ASSERT_TRUE(log.ok()) << log.error().message;
    log_ = std::move(*log);
    serve([&](service::ServerConfig& config) { config.snapshot_bytes = snapshot_bytes; });
  }
  void restartProcess(uint64_t snapshot_bytes = 4 << 20) {
    stop();
    start(snapshot_bytes);
  }

  std::vector<uint64_t> ids(const std::string& world) {
    v1::QueryInstancesRequest request;
    request.set_world(world);
    request.set_radius(1e6f);
    v1::QueryInstancesResponse answer;
    EXPECT_TRUE(call(&Stub::QueryInstances, request, answer).status.ok());
    std::vector<uint64_t> ids;
    for (const auto& instance : answer.instances()) ids.push_back(instance.id());
    return ids;
  }

  uint64_t checksum(const std::string& world) {
    grpc::ClientContext context;
    v1::WatchTelemetryRequest request;
    request.set_world(world);
    const auto reader = telemetry_->Watch(&context, request);
    v1::TelemetrySample sample;
    EXPECT_TRUE(reader->Read(&sample));
    context.TryCancel();
    return sample.worlds_size() == 1 ? sample.worlds(0).checksum() : 0;
  }

  /// Edits of every kind, so that ids, places and light differ from the base scene's.
  void edit(const std::string& world) {
    v1::ApplyEditsResponse built, other;
    ASSERT_TRUE(apply(buildRequest(world, "build 1", 5), built).status.ok());
    ASSERT_TRUE(apply(buildRequest(world, "build 2", 6), other).status.ok());
    v1::ApplyEditsRequest request;
    request.set_world(world);
    request.set_request_id("change");
    auto& move = *request.add_edits()->mutable_move();
    move.set_id(built.built(0).first());
    for (const float number : {-7.0f, 1.0f, 2.0f, 0.0f, 0.0f, 0.0f, 1.0f, 2.0f}) move.add_placement(number);
    request.add_edits()->mutable_destroy()->add_ids(1);
    request.add_edits()->mutable_set_sun()->mutable_daylight()->set_elevation(0.5f);
    ASSERT_TRUE(apply(request, other).status.ok());
  }
};

TEST_F(DurableTest, ARestartBringsEveryWorldBackAsItWas) {
  for (const char* world : {"a", "b"}) {
    makeWorld(world);
    edit(world);
  }
  v1::ApplyEditsResponse first, again;
  ASSERT_TRUE(apply(buildRequest("b", "last", 9), first).status.ok());
  const auto ids_before = ids("b");
  const uint64_t checksum_a = checksum("a"), checksum_b = checksum("b");
  EXPECT_NE(checksum_a, checksum_b);

  restartProcess();
  for (const char* world : {"a", "b"}) EXPECT_EQ(waitUntilReady(world).state(), v1::WORLD_STATE_READY);
  EXPECT_EQ(seqOf("a"), 3u);
  EXPECT_EQ(seqOf("b"), 4u);
  EXPECT_EQ(checksum("a"), checksum_a);
  EXPECT_EQ(checksum("b"), checksum_b);
  EXPECT_EQ(ids("b"), ids_before);

  // A client that did not get its answer asks again.
  ASSERT_TRUE(apply(buildRequest("b", "last", 9), again).status.ok());
  EXPECT_TRUE(again.replayed());
  EXPECT_EQ(again.seq(), first.seq());
  EXPECT_EQ(again.epoch(), first.epoch());
  EXPECT_EQ(again.built(0).first(), first.built(0).first());
  EXPECT_EQ(ids("b"), ids_before);

  // And the world goes on: the next seq, the next id, a later epoch.
  ASSERT_TRUE(apply(buildRequest("b", "next", 10), again).status.ok());
  EXPECT_EQ(again.seq(), first.seq() + 1);
  EXPECT_EQ(again.built(0).first(), first.built(0).first() + 1);
  EXPECT_GT(again.epoch(), first.epoch());
  expectServing("a");
}

TEST_F(DurableTest, SnapshotsReplaceRecordsAndNothingElse) {
  restartProcess(1000);
  makeWorld("w");
  constexpr int kEdits = 100;
  v1::ApplyEditsResponse answer;
  for (int i = 0; i < kEdits; ++i)
    ASSERT_TRUE(apply(buildRequest("w", "r" + std::to_string(i), float(i)), answer).status.ok());
  eventually([&] { return !log_->read("w", 0, 1).ok(); }, "records were truncated");
  const auto ids_before = ids("w");
  const uint64_t checksum_before = checksum("w");

  restartProcess(1000);
  waitUntilReady("w");
  EXPECT_EQ(seqOf("w"), uint64_t{kEdits});
  EXPECT_EQ(ids("w"), ids_before);
  EXPECT_EQ(checksum("w"), checksum_before);
  ASSERT_TRUE(apply(buildRequest("w", "r0", 0), answer).status.ok());
  EXPECT_TRUE(answer.replayed());
  EXPECT_EQ(answer.seq(), 1u);
  ASSERT_EQ(answer.built_size(), 1);
  EXPECT_EQ(answer.built(0).count(), 1u);
}

TEST_F(DurableTest, ADeletedWorldStaysDeleted) {
  makeWorld("gone");
  makeWorld("stays");
  v1::DeleteWorldRequest request;
  request.set_world("gone");
  v1::DeleteWorldResponse answer;
  ASSERT_TRUE(call(&Stub::DeleteWorld, request, answer).status.ok());
  restartProcess();
  v1::ListWorldsResponse list;
  ASSERT_TRUE(call(&Stub::ListWorlds, v1::ListWorldsRequest(), list).status.ok());
  ASSERT_EQ(list.worlds_size(), 1);
  EXPECT_EQ(list.worlds(0).world(), "stays");
}

TEST_F(DurableTest, AWorldWhoseSceneHasChangedIsNotGuessedAt) {
  makeWorld("w");
  edit("w");
  const uint64_t before = checksum("w");
  const fs::path file = folder_ / "triangle.gltf", kept = folder_ / "kept.gltf";
  fs::copy_file(file, kept);
  std::string text{std::istreambuf_iterator<char>(std::ifstream(file).rdbuf()), {}};
  text.replace(text.find("[3, 0, 0]"), 9, "[4, 0, 0]");
  std::ofstream(file) << text;

  restartProcess();
  const auto failed = waitUntilReady("w");
  EXPECT_EQ(failed.state(), v1::WORLD_STATE_FAILED);
  EXPECT_THAT(failed.error(), testing::HasSubstr("gltf triangle.gltf is not the scene any more"));
  v1::ApplyEditsResponse answer;
  expectFailure(apply(buildRequest("w", "x", 1), answer), Code::FAILED_PRECONDITION, v1::ERROR_REASON_WORLD_FAILED,
                "world");

  fs::remove(file);
  restartProcess();
  EXPECT_THAT(waitUntilReady("w").error(), testing::HasSubstr("no file"));

  fs::rename(kept, file);
  restartProcess();
  EXPECT_EQ(waitUntilReady("w").state(), v1::WORLD_STATE_READY);
  EXPECT_EQ(checksum("w"), before);
}

TEST_F(DurableTest, DamageIsDataLossOfThatWorldAlone) {
  for (const char* world : {"bad", "good"}) {
    makeWorld(world);
    v1::ApplyEditsResponse answer;
    ASSERT_TRUE(apply(buildRequest(world, std::string("request of ") + world, 1), answer).status.ok());
  }
  stop();
  std::string bytes{std::istreambuf_iterator<char>(std::ifstream(logFolder() / "edits.db").rdbuf()), {}};
  const size_t at = bytes.find("request of bad");
  ASSERT_NE(at, std::string::npos);
  bytes[at] = 'R';
  std::ofstream(logFolder() / "edits.db", std::ios::binary) << bytes;

  start();
  EXPECT_EQ(waitUntilReady("bad").state(), v1::WORLD_STATE_FAILED);
  v1::ApplyEditsResponse answer;
  expectFailure(apply(buildRequest("bad", "x", 1), answer), Code::DATA_LOSS, v1::ERROR_REASON_DATA_LOSS, "world");
  EXPECT_EQ(waitUntilReady("good").state(), v1::WORLD_STATE_READY);
  expectServing("good");

  // It can be given up, and made again.
  v1::DeleteWorldRequest request;
  request.set_world("bad");
  v1::DeleteWorldResponse deleted;
  ASSERT_TRUE(call(&Stub::DeleteWorld, request, deleted).status.ok());
  makeWorld("bad");
  EXPECT_EQ(seqOf("bad"), 0u);
}

TEST_F(DurableTest, ADamagedWorldIsRepairedWithoutARestart) {
  makeWorld("bad");
  v1::ApplyEditsResponse answer;
  for (int i = 1; i <= 5; ++i)
    ASSERT_TRUE(apply(buildRequest("bad", "request " + std::to_string(i), float(i)), answer).status.ok());
  const auto all = ids("bad");
  v1::RepairWorldRequest request;
  v1::RepairWorldResponse repaired;
  request.set_world("bad");
  request.set_accept_loss(100);
  expectFailure(call(&Stub::RepairWorld, request, repaired), Code::FAILED_PRECONDITION, v1::ERROR_REASON_UNSUPPORTED,
                "world");
  stop();
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((logFolder() / "edits.db").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "UPDATE record SET bytes = x'00' WHERE seq = 4", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);

  start();
  EXPECT_EQ(waitUntilReady("bad").state(), v1::WORLD_STATE_FAILED);
  const auto lost = apply(buildRequest("bad", "x", 1), answer);
  EXPECT_EQ(lost.status.error_code(), Code::DATA_LOSS);
  EXPECT_THAT(lost.status.error_message(), testing::HasSubstr("helio worlds repair bad --accept-loss N"));
  request.set_accept_loss(1);
  const auto refused = call(&Stub::RepairWorld, request, repaired);
  expectFailure(refused, Code::FAILED_PRECONDITION, v1::ERROR_REASON_UNSUPPORTED, "accept_loss", "1");
  EXPECT_EQ(refused.detail.value(), "2");
  request.set_accept_loss(2);
  ASSERT_TRUE(call(&Stub::RepairWorld, request, repaired).status.ok());
  EXPECT_EQ(repaired.lost_edits(), 2u);
  EXPECT_EQ(repaired.seq(), 3u);
  EXPECT_EQ(waitUntilReady("bad").state(), v1::WORLD_STATE_READY);
  EXPECT_EQ(seqOf("bad"), repaired.seq());
  EXPECT_EQ(ids("bad").size(), all.size() - repaired.lost_edits());
  ASSERT_TRUE(apply(buildRequest("bad", "request 3", 3), answer).status.ok());
  EXPECT_TRUE(answer.replayed());
  ASSERT_TRUE(apply(buildRequest("bad", "request 4", 4), answer).status.ok());
  EXPECT_FALSE(answer.replayed()) << "a lost edit is done again";
  expectServing("bad");
  restartProcess();
  EXPECT_EQ(waitUntilReady("bad").state(), v1::WORLD_STATE_READY);
}

TEST_F(DurableTest, TheCityOfTheCommandLineIsMadeOnce) {
  ASSERT_TRUE(server_->createCity("city", {1, 1000}).ok());
  waitUntilReady("city");
  restartProcess();
  EXPECT_TRUE(server_->createCity("city", {1, 1000}).ok());
  EXPECT_EQ(server_->createCity("city", {2, 1000}).error().kind, ErrorKind::conflict);
  EXPECT_EQ(waitUntilReady("city").state(), v1::WORLD_STATE_READY);
}

/// Another log behind it.
class LogBefore : public store::EditLog {
 public:
  explicit LogBefore(std::unique_ptr<store::EditLog> log) : log_(std::move(log)) {}

  store::Append append(const std::string& world, uint64_t epoch, const store::Record& record) override {
    return log_->append(world, epoch, record);
  }
  Result<uint64_t> acquire(const std::string& w) override { return log_->acquire(w); }
  Result<std::optional<store::Receipt>> receipt(const std::string& w, const std::string& id) const override {
    return log_->receipt(w, id);
  }
  Result<std::vector<store::Record>> read(const std::string& w, uint64_t after, size_t limit) const override {
    return log_->read(w, after, limit);
  }
  std::shared_ptr<void> watch(const std::string& w, std::function<void(const store::Record&)> f) override {
    return log_->watch(w, std::move(f));
  }
  Result<void> putSnapshot(const std::string& w, uint64_t e, const store::Snapshot& s) override {
    return log_->putSnapshot(w, e, s);
  }
  Result<std::optional<store::Snapshot>> snapshot(const std::string& w) const override { return log_->snapshot(w); }
  Result<void> truncate(const std::string& w, uint64_t e, uint64_t seq) override { return log_->truncate(w, e, seq); }
  Result<void> putManifest(const std::string& w, uint64_t e, const std::string& m) override {
    return log_->putManifest(w, e, m);
  }
  Result<std::string> manifest(const std::string& w) const override { return log_->manifest(w); }
  Result<std::vector<std::string>> worlds() const override { return log_->worlds(); }
  Result<store::Repair> repair(const std::string& w, uint64_t most) override { return log_->repair(w, most); }
  Result<void> remove(const std::string& w) override { return log_->remove(w); }

 private:
  std::unique_ptr<store::EditLog> log_;
};

/// Loses its answers: the record is written, and nobody hears of it.
class MuteLog final : public LogBefore {
 public:
  using LogBefore::LogBefore;
  std::atomic<bool> mute = false;

  store::Append append(const std::string& world, uint64_t epoch, const store::Record& record) override {
    const auto answer = LogBefore::append(world, epoch, record);
    return mute ? store::Append::unknown : answer;
  }
};

/// Its disk takes as long as it is told to.
class SlowLog final : public LogBefore {
 public:
  using LogBefore::LogBefore;

  void hold(bool hold) {
    const std::lock_guard lock(mutex_);
    hold_ = hold;
    changed_.notify_all();
  }
  bool held() const {
    const std::lock_guard lock(mutex_);
    return held_;
  }
  store::Append append(const std::string& world, uint64_t epoch, const store::Record& record) override {
    {
      std::unique_lock lock(mutex_);
      held_ = hold_;
      changed_.wait(lock, [this] { return !hold_; });
    }
    return LogBefore::append(world, epoch, record);
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool hold_ = false, held_ = false;
};

TEST_F(DurableTest, AnEditWhoseDeadlineIsOverBeforeItsTurnIsNotDone) {
  server_.reset();
  auto slow = std::make_unique<SlowLog>(store::makeMemoryEditLog());
  SlowLog& log = *slow;
  log_ = std::move(slow);
  serve([](service::ServerConfig&) {});
  makeWorld("w");
  log.hold(true);
  v1::ApplyEditsResponse first_answer, answer;
  std::thread first([&] { EXPECT_TRUE(apply(buildRequest("w", "first", 1), first_answer).status.ok()); });
  eventually([&] { return log.held(); }, "the first edit is at the disk");
  {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(300));
    EXPECT_EQ(worlds_->ApplyEdits(&context, buildRequest("w", "late", 2), &answer).error_code(),
              Code::DEADLINE_EXCEEDED);
  }
  // On the wire a deadline is a rounded time to go: the server's is a little later than the client's.
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  log.hold(false);
  first.join();
  // A call behind it on the same connection is answered: the late one had its turn.
  ASSERT_TRUE(apply(buildRequest("w", "next", 3), answer).status.ok());
  EXPECT_EQ(answer.seq(), 2u) << "who had given up was served";
  EXPECT_FALSE(log_->find("w", "late"));
}

TEST_F(DurableTest, ARepeatSettlesAnUnknownOutcome) {
  server_.reset();
  auto mute = std::make_unique<MuteLog>(store::makeMemoryEditLog());
  MuteLog& log = *mute;
  log_ = std::move(mute);
  serve([](service::ServerConfig&) {});
  makeWorld("w");
  const auto before = ids("w").size();
  v1::ApplyEditsResponse answer;
  log.mute = true;
  const auto lost = apply(buildRequest("w", "x", 1), answer);
  expectFailure(lost, Code::UNAVAILABLE, v1::ERROR_REASON_OUTCOME_UNKNOWN, "request_id");
  log.mute = false;
  ASSERT_TRUE(apply(buildRequest("w", "x", 1), answer).status.ok());
  EXPECT_TRUE(answer.replayed());
  EXPECT_EQ(answer.seq(), 1u);
  EXPECT_EQ(ids("w").size(), before + 1);  // the world has it, once
  ASSERT_TRUE(apply(buildRequest("w", "y", 2), answer).status.ok());
  EXPECT_EQ(answer.seq(), 2u);
  EXPECT_EQ(ids("w").size(), before + 2);
}

}  // namespace
}  // namespace helio::test
