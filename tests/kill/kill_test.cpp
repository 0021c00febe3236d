// The program as it runs in production, killed while clients edit: SIGKILL leaves it no last word.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "lib/connection.h"

namespace helio {
namespace {

namespace fs = std::filesystem;
namespace v1 = heliograph::v1;
using namespace std::chrono_literals;

/// heliographd with the synthetic renderer and a city, as long as the object lives.
class Process {
 public:
  explicit Process(const fs::path& folder) : port_file_(folder / "port.txt") {
    fs::remove(port_file_);
    const std::string log = (folder / "log").string(), port = port_file_.string();
    const std::vector<const char*> arguments = {HELIOGRAPHD,  "--renderer",  "synthetic", "--listen", "127.0.0.1:0",
                                                "--log-dir",  log.c_str(),   "--city",    "1000",     "--port-file",
                                                port.c_str(), "--log-level", "error",     nullptr};
    pid_ = fork();
    if (pid_ == 0) {
      execv(HELIOGRAPHD, const_cast<char* const*>(arguments.data()));
      _exit(127);
    }
    for (int i = 0; i < 3000 && address_.empty(); ++i) {
      std::this_thread::sleep_for(10ms);
      std::getline(std::ifstream(port_file_), address_);
    }
    EXPECT_FALSE(address_.empty()) << "heliographd did not become ready";
  }
  ~Process() { kill(); }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  const std::string& address() const { return address_; }
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }

 private:
  const fs::path port_file_;
  std::string address_;
  pid_t pid_ = 0;
};

class Kill : public testing::Test {
 protected:
  Kill() {
    std::string name = testing::TempDir() + "heliograph_kill_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~Kill() override { fs::remove_all(folder_); }

  /// Builds one tree; where it stands tells which request it was.
  static v1::ApplyEditsRequest requestOf(uint64_t number, const std::string& prefab) {
    v1::ApplyEditsRequest request;
    request.set_world("city");
    request.set_request_id("request " + std::to_string(number));
    auto& build = *request.add_edits()->mutable_build();
    build.set_prefab(prefab);
    for (const float value : {float(number), 900.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 1.0f}) build.add_placements(value);
    return request;
  }

  /// Edits until the connection fails; notes what was acknowledged, by request.
  void edit(const std::string& address, const std::string& prefab) {
    const auto stub = v1::WorldService::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
    for (;;) {
      const uint64_t number = ++requests_;
      v1::ApplyEditsResponse answer;
      grpc::ClientContext context;
      if (!stub->ApplyEdits(&context, requestOf(number, prefab), &answer).ok()) return;
      const std::lock_guard lock(mutex_);
      acknowledged_[number] = answer;
    }
  }

  /// Instances at the height of the builds, by request number.
  static std::map<uint64_t, std::vector<uint64_t>> builtIn(client::Connection& connection) {
    std::map<uint64_t, std::vector<uint64_t>> built;
    const auto all = connection.instances("city", 0, 0, 1e6f, 1'000'000);
    EXPECT_TRUE(all.ok()) << (all ? "" : all.error().message);
    if (!all) return built;
    for (const auto& instance : *all)
      if (instance.transform(10) == 900.0f) built[uint64_t(instance.transform(9))].push_back(instance.id());
    return built;
  }

  fs::path folder_;
  std::atomic<uint64_t> requests_ = 0;
  std::mutex mutex_;
  std::map<uint64_t, v1::ApplyEditsResponse> acknowledged_;
};

TEST_F(Kill, EveryAcknowledgedEditIsThereOnceAndUnderItsNumbers) {
  constexpr int kKills = 3, kClients = 3;
  std::mt19937 random(7);
  std::string prefab;
  for (int round = 0; round <= kKills; ++round) {
    Process server(folder_);
    client::Connection connection(server.address());
    const auto world = connection.readyWorld("city");
    ASSERT_TRUE(world.ok()) << world.error().message;

    const auto built = builtIn(connection);
    for (const auto& [number, ids] : built) EXPECT_EQ(ids.size(), 1u) << "request " << number << " is there twice";
    uint64_t last_seq = 0;
    for (const auto& [number, answer] : acknowledged_) {
      const auto found = built.find(number);
      ASSERT_NE(found, built.end()) << "request " << number << " was acknowledged and is lost";
      EXPECT_EQ(found->second.front(), answer.built(0).first());
      last_seq = std::max(last_seq, answer.seq());
    }
    EXPECT_GE(world->seq(), last_seq);
    if (round > 0) {
      const auto& [number, first] = *acknowledged_.rbegin();
      const auto again = connection.apply(requestOf(number, prefab));
      ASSERT_TRUE(again.ok()) << again.error().message;
      EXPECT_TRUE(again->replayed());
      EXPECT_EQ(again->seq(), first.seq());
    }
    if (round == kKills) break;

    const auto prefabs = connection.prefabs("city");
    ASSERT_TRUE(prefabs.ok());
    for (const auto& candidate : *prefabs)
      if (candidate.buildable()) prefab = candidate.name();
    std::vector<std::thread> clients;
    for (int i = 0; i < kClients; ++i) clients.emplace_back([&] { edit(server.address(), prefab); });
    const size_t before = acknowledged_.size();
    const size_t enough = before + std::uniform_int_distribution<size_t>(20, 100)(random);
    const auto count = [&] {
      const std::lock_guard lock(mutex_);
      return acknowledged_.size();
    };
    for (int i = 0; i < 6000 && count() < enough; ++i) std::this_thread::sleep_for(10ms);
    server.kill();
    for (auto& client : clients) client.join();
    EXPECT_GE(acknowledged_.size(), enough);
  }
}

}  // namespace
}  // namespace helio
