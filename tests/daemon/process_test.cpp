// The programs as people run them: keys are made, the line is pasted, a token comes and goes, the server is told to
// end.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "lib/viewer_session.h"

namespace helio {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

struct Ran {
  int status = -1;
  std::string out, err;
};

class ProcessTest : public testing::Test {
 protected:
  ProcessTest() {
    std::string name = testing::TempDir() + "heliograph_process_XXXXXX";
    folder_ = mkdtemp(name.data());
    setenv("HELIOGRAPH_CREDENTIALS", (folder_ / "credentials.json").c_str(), 1);
  }
  ~ProcessTest() override {
    if (server_ > 0) {
      kill(server_, SIGKILL);
      waitpid(server_, nullptr, 0);
    }
    unsetenv("HELIOGRAPH_CREDENTIALS");
    fs::remove_all(folder_);
  }

  pid_t spawn(const std::vector<std::string>& command, const fs::path& out, const fs::path& err) {
    const pid_t pid = fork();
    if (pid != 0) return pid;
    std::vector<char*> argv;
    for (const auto& argument : command) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    if (!freopen(out.c_str(), "w", stdout) || !freopen(err.c_str(), "w", stderr)) _exit(126);
    execv(argv[0], argv.data());
    _exit(127);
  }
  Ran run(const std::vector<std::string>& command) {
    const auto out = folder_ / "out.txt", err = folder_ / "err.txt";
    const pid_t pid = spawn(command, out, err);
    int status = 0;
    waitpid(pid, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), read(out), read(err)};
  }
  Ran helio(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), HELIO);
    return run(arguments);
  }
  std::string keys() const { return (folder_ / "keys").string(); }

  /// A synthetic server with a small city, at a port of its own.
  void serve(const std::vector<std::string>& more, const std::string& listen = "127.0.0.1:0") {
    const auto port_file = folder_ / "port.txt";
    fs::remove(port_file);
    std::vector<std::string> command = {HELIOGRAPHD, "--renderer", "synthetic",   "--listen",         listen,
                                        "--city",    "1000",       "--port-file", port_file.string(), "--log-format",
                                        "json"};
    command.insert(command.end(), more.begin(), more.end());
    server_ = spawn(command, log(), folder_ / "server_err.txt");
    address_.clear();
    for (int i = 0; i < 6000 && address_.empty(); ++i) {
      std::this_thread::sleep_for(10ms);
      std::getline(std::ifstream(port_file), address_);
    }
    ASSERT_FALSE(address_.empty()) << "heliographd did not become ready: " << read(folder_ / "server_err.txt");
  }
  fs::path log() const { return folder_ / "log.jsonl"; }
  /// How the server ended when it was told to.
  int end() {
    kill(server_, SIGTERM);
    int status = 0;
    waitpid(server_, &status, 0);
    server_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  /// The pasted line, as words, for the port that was bound.
  std::vector<std::string> pasted(const std::string& line) const {
    std::istringstream words(line);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    arguments[0] = HELIO;
    arguments[2] = address_;
    return arguments;
  }

  fs::path folder_;
  std::string address_;
  pid_t server_ = 0;
};

TEST_F(ProcessTest, TheFirstHourWithKeys) {
  const auto init = run({HELIOGRAPHD, "init", "--keys", keys(), "--host", "heliograph.example"});
  ASSERT_EQ(init.status, 0) << init.err;
  EXPECT_EQ(init.out.rfind("helio login heliograph.example:7700 --ca-sha256 ", 0), 0u) << init.out;
  EXPECT_EQ(std::count(init.out.begin(), init.out.end(), '\n'), 1);
  EXPECT_NE(run({HELIOGRAPHD, "init", "--keys", keys()}).status, 0) << "keys were made twice";
  const auto second = run({HELIOGRAPHD, "init", "--keys", keys(), "--new-token"});
  EXPECT_EQ(second.out.rfind("helio login heliograph.example:7700 --ca-sha256 ", 0), 0u) << second.out;
  serve({"--keys", keys()});

  // Nobody comes in without the line.
  EXPECT_NE(helio({"worlds", "list", "--server", address_}).status, 0);
  auto line = pasted(init.out);
  auto wrong = line;
  wrong[4][0] = wrong[4][0] == '0' ? '1' : '0';
  EXPECT_THAT(run(wrong).err, HasSubstr("fingerprint"));
  wrong = line;
  wrong[6].back() = wrong[6].back() == '0' ? '1' : '0';
  EXPECT_THAT(run(wrong).err, HasSubstr("UNAUTHENTICATED"));
  EXPECT_FALSE(fs::exists(folder_ / "credentials.json")) << "what does not let in was kept";

  const auto login = run(line);
  ASSERT_EQ(login.status, 0) << login.err;
  EXPECT_THAT(login.out, HasSubstr("scope admin"));
  EXPECT_EQ(fs::status(folder_ / "credentials.json").permissions(), fs::perms(0600));
  // From now on no flag is needed.
  EXPECT_THAT(helio({"worlds", "list"}).out, HasSubstr("city"));

  const auto made = helio({"token", "create", "Ann", "--scope", "view", "--world", "city", "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  const auto token = nlohmann::json::parse(made.out);
  EXPECT_THAT(helio({"token", "list"}).out, HasSubstr("Ann"));
  setenv("HELIOGRAPH_CREDENTIALS", (folder_ / "ann.json").c_str(), 1);
  auto anns = line;
  anns[6] = token["token"].get<std::string>();
  ASSERT_EQ(run(anns).status, 0);
  const auto refused = helio({"worlds", "delete", "city"});
  EXPECT_NE(refused.status, 0);
  EXPECT_THAT(refused.err, HasSubstr("PERMISSION_DENIED"));
  EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
  {
    client::Connection connection(address_);
    client::ViewerSession::Options options;
    options.world = "city";
    options.settings.set_width(64);
    options.settings.set_height(32);
    auto session = client::ViewerSession::attach(connection, options);
    ASSERT_TRUE(session.ok()) << session.error().message;
    setenv("HELIOGRAPH_CREDENTIALS", (folder_ / "credentials.json").c_str(), 1);
    ASSERT_EQ(helio({"token", "revoke", token["id"].get<std::string>()}).status, 0);
    for (;;) {
      const auto received = (*session)->next();
      if (!received) {
        EXPECT_THAT(received.error().message, HasSubstr("UNAUTHENTICATED"));
        break;
      }
      ASSERT_TRUE(received->has_value());
      (*session)->shown(**received, client::Clock::now());
    }
  }
  EXPECT_EQ(helio({"logout", "--server", address_}).status, 0);
  EXPECT_NE(helio({"worlds", "list", "--server", address_}).status, 0);
  EXPECT_EQ(end(), 0);

  // Every line of the log is an object, and no secret is in it.
  std::istringstream lines(read(log()));
  int count = 0;
  for (std::string text; std::getline(lines, text); ++count) {
    const auto object = nlohmann::json::parse(text, nullptr, false);
    ASSERT_TRUE(object.is_object()) << text;
    for (const char* field : {"time", "level", "message"}) EXPECT_TRUE(object.contains(field)) << text;
    for (const auto& secret : {line[6], anns[6]})
      EXPECT_EQ(text.find(secret.substr(secret.rfind('_') + 1)), std::string::npos) << "a token was logged";
  }
  EXPECT_GT(count, 3);
}

TEST_F(ProcessTest, OneSignalTellsTheViewersAndEndsInOrder) {
  serve({"--ops-listen", "127.0.0.1:0", "--log-dir", (folder_ / "worlds").string()});
  const std::string text = read(log());
  const auto at = text.find("health and metrics on ");
  ASSERT_NE(at, std::string::npos);
  const auto ops = text.substr(at + 22, text.find('"', at) - at - 22);
  httplib::Client http("http://" + ops);
  for (int i = 0; i < 3000; ++i) {
    const auto ready = http.Get("/readyz");
    if (ready && ready->status == 200) break;
    std::this_thread::sleep_for(10ms);
  }
  const auto ready = http.Get("/readyz"), metrics = http.Get("/metrics");
  ASSERT_TRUE(ready && metrics);
  EXPECT_EQ(ready->status, 200) << ready->body;
  EXPECT_THAT(metrics->body, HasSubstr("heliograph_worlds{state=\"ready\"} 1"));

  client::Connection connection(address_);
  client::ViewerSession::Options options;
  options.world = "city";
  options.settings.set_width(64);
  options.settings.set_height(32);
  auto session = client::ViewerSession::attach(connection, options);
  ASSERT_TRUE(session.ok()) << session.error().message;
  std::atomic<bool> told = false;
  std::thread reader([&] {
    for (;;) {
      const auto received = (*session)->next();
      if (!received) {
        told = received.error().message.find("going down") != std::string::npos;
        return;
      }
      (*session)->shown(**received, client::Clock::now());
    }
  });
  EXPECT_EQ(end(), 0);
  reader.join();
  EXPECT_TRUE(told) << "the viewer was not told";
}

TEST_F(ProcessTest, ASecondSignalEndsAtOnce) {
  serve({"--synthetic-frame-us", "3600000000"});  // a tick takes an hour, and an orderly end waits for it
  client::Connection connection(address_);
  client::ViewerSession::Options options;
  options.world = "city";
  options.settings.set_width(64);
  options.settings.set_height(32);
  auto session = client::ViewerSession::attach(connection, options);
  ASSERT_TRUE(session.ok()) << session.error().message;
  kill(server_, SIGTERM);
  while (read(log()).find("draining") == std::string::npos) std::this_thread::sleep_for(10ms);
  int status = 0;
  EXPECT_EQ(waitpid(server_, &status, WNOHANG), 0) << "it did not wait for the tick";
  EXPECT_EQ(end(), EXIT_FAILURE);
}

/// The inodes of this process' sockets.
std::set<std::string> socketsOf(pid_t pid) {
  std::set<std::string> sockets;
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(pid) + "/fd")) {
    std::error_code gone;
    const std::string target = fs::read_symlink(entry, gone).string();
    if (target.rfind("socket:[", 0) == 0) sockets.insert(target.substr(8, target.size() - 9));
  }
  return sockets;
}

/// host:port (in hexadecimal) of every socket of a process that waits for strangers: TCP that listens, any UDP, and
/// paths of UNIX sockets that listen.
std::set<std::string> listeningOf(pid_t pid) {
  const auto sockets = socketsOf(pid);
  std::set<std::string> out;
  for (const char* protocol : {"tcp", "tcp6", "udp", "udp6"}) {
    std::istringstream lines(read(fs::path("/proc") / std::to_string(pid) / "net" / protocol));
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line)) {
      std::istringstream words(line);
      std::vector<std::string> word{std::istream_iterator<std::string>(words), {}};
      const bool waits = std::string(protocol).rfind("udp", 0) == 0 || word.at(3) == "0A";
      if (!waits || sockets.count(word.at(9)) == 0) continue;
      const std::string mapped = "0000000000000000FFFF0000", &local = word.at(1);  // an IPv4 address in an IPv6 socket
      out.insert(local.rfind(mapped, 0) == 0 ? local.substr(mapped.size()) : local);
    }
  }
  std::istringstream lines(read(fs::path("/proc") / std::to_string(pid) / "net/unix"));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::istringstream words(line);
    std::vector<std::string> word{std::istream_iterator<std::string>(words), {}};
    const bool listens = (std::stoul(word.at(3), nullptr, 16) & 0x10000) != 0;
    if (listens && sockets.count(word.at(6)) != 0) out.insert("unix " + line);
  }
  return out;
}

std::string hexadecimalPort(const std::string& address) {
  char text[8];
  std::snprintf(text, sizeof text, "%04X", static_cast<unsigned>(std::stoul(address.substr(address.rfind(':') + 1))));
  return text;
}

TEST_F(ProcessTest, NothingListensButWhatWasAskedFor) {
  constexpr const char* kLoopback = "0100007F:";
  serve({});
  EXPECT_EQ(listeningOf(server_), std::set<std::string>{kLoopback + hexadecimalPort(address_)});
  EXPECT_EQ(end(), 0);
  serve({"--ops-listen", "127.0.0.1:0"});
  const std::string text = read(log());
  const auto at = text.find("health and metrics on ");
  ASSERT_NE(at, std::string::npos);
  const auto ops = text.substr(at + 22, text.find('"', at) - at - 22);
  EXPECT_EQ(listeningOf(server_),
            (std::set<std::string>{kLoopback + hexadecimalPort(address_), kLoopback + hexadecimalPort(ops)}));
  EXPECT_EQ(end(), 0);
}

/// By what --help says: a flag that is added without its variable is found.
TEST_F(ProcessTest, EveryFlagHasItsVariable) {
  int flags = 0;
  for (const std::string command : {"", "init", "doctor"}) {
    const auto help = command.empty() ? run({HELIOGRAPHD, "--help"}) : run({HELIOGRAPHD, command, "--help"});
    ASSERT_EQ(help.status, 0) << help.err;
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);) {
      if (line.rfind("  --", 0) != 0) continue;
      const std::string name = line.substr(4, line.find_first_of(" =", 4) - 4);
      if (name == "version" || name == "config") continue;  // CLI11 tells of HELIOGRAPH_CONFIG in words
      std::string variable = "HELIOGRAPH_" + name;
      for (char& c : variable) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      EXPECT_THAT(line, HasSubstr("(Env:" + variable + ")"));
      ++flags;
    }
  }
  EXPECT_GE(flags, 40);
}

TEST_F(ProcessTest, AViewerGoesOnWhenTheServerHasRestarted) {
  const auto worlds = (folder_ / "worlds").string();
  serve({"--log-dir", worlds});
  const std::string address = address_;
  client::Connection connection(address);
  client::ViewerSession::Options options;
  options.world = "city";
  options.settings.set_width(64);
  options.settings.set_height(32);
  options.reattach = 60s;
  auto session = client::ViewerSession::attach(connection, options);
  ASSERT_TRUE(session.ok()) << session.error().message;
  const auto shown = [&] {
    auto received = (*session)->next();
    EXPECT_TRUE(received.ok()) << received.error().message;
    if (received && *received) (*session)->shown(**received, client::Clock::now());
    return received.ok() && received->has_value();
  };
  ASSERT_TRUE(shown());
  kill(server_, SIGKILL);
  waitpid(server_, nullptr, 0);
  serve({"--log-dir", worlds}, address);
  while ((*session)->reattached() == 0) ASSERT_TRUE(shown());
  EXPECT_TRUE(shown());
  EXPECT_EQ(end(), 0);
}

TEST_F(ProcessTest, TheDoctorFindsWhatIsWrong) {
  const auto healthy = run({HELIOGRAPHD, "doctor", "--json", "--renderer", "synthetic", "--listen", "127.0.0.1:0",
                            "--log-dir", (folder_ / "worlds").string()});
  EXPECT_EQ(healthy.status, 0) << healthy.out << healthy.err;
  EXPECT_TRUE(nlohmann::json::parse(healthy.out)["can_serve"].get<bool>());

  serve({"--log-dir", (folder_ / "worlds").string()});
  const auto ill = run({HELIOGRAPHD, "doctor", "--json", "--renderer", "synthetic", "--listen", address_, "--log-dir",
                        (folder_ / "worlds").string(), "--keys", keys()});
  EXPECT_EQ(ill.status, 1);
  const auto document = nlohmann::json::parse(ill.out);
  EXPECT_FALSE(document["can_serve"].get<bool>());
  for (const auto& finding : document["findings"]) {
    const auto check = finding["check"].get<std::string>();
    if (check == "port" || check == "log folder" || check == "keys") {
      EXPECT_EQ(finding["grade"], "bad") << finding.dump();
    }
  }
  const auto open = run({HELIOGRAPHD, "doctor", "--renderer", "synthetic", "--listen", "0.0.0.0:0"});
  EXPECT_EQ(open.status, 1);
  EXPECT_THAT(open.out, HasSubstr("heliographd init --keys"));
  EXPECT_EQ(end(), 0);
}

}  // namespace
}  // namespace helio
