#include "load/spawned_server.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>
#include <utility>

namespace helio::load {
namespace {

using namespace std::chrono_literals;

constexpr int kNotStarted = 127;

}  // namespace

Result<std::unique_ptr<SpawnedServer>> SpawnedServer::start(const std::string& program,
                                                            std::vector<std::string> flags) {
  const auto failed = [&](const std::string& why) {
    return Error{ErrorKind::unavailable, "could not start " + program + ": " + why, "spawn", program, {}};
  };
  std::string folder = std::filesystem::temp_directory_path() / "helio_load_XXXXXX";
  if (!mkdtemp(folder.data())) return failed("no temporary folder " + folder);
  std::unique_ptr<SpawnedServer> server(new SpawnedServer);
  server->folder_ = folder;
  const std::string port_file = server->folder_ / "port", log = server->folder_ / "log";

  flags.insert(flags.begin(), program);
  for (const char* flag : {"--listen", "127.0.0.1:0", "--log-level", "warn", "--port-file"}) flags.emplace_back(flag);
  flags.push_back(port_file);
  std::vector<char*> arguments;
  for (auto& flag : flags) arguments.push_back(flag.data());
  arguments.push_back(nullptr);

  server->pid_ = fork();
  if (server->pid_ < 0) return failed("no process");
  if (server->pid_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // it never outlives the test, however that ends
    const int out = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
    execv(program.c_str(), arguments.data());
    _exit(kNotStarted);
  }
  while (server->address_.empty()) {
    int status = 0;
    if (waitpid(server->pid_, &status, WNOHANG) == server->pid_) {
      server->pid_ = 0;
      if (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted) return failed("there is no such program");
      return failed(server->lastLine());
    }
    std::this_thread::sleep_for(20ms);
    std::getline(std::ifstream(port_file), server->address_);
  }
  return server;
}

SpawnedServer::~SpawnedServer() {
  if (pid_ > 0) {
    ::kill(pid_, SIGTERM);
    for (int i = 0; i < 1000 && waitpid(pid_, nullptr, WNOHANG) == 0; ++i) {
      if (i == 999) {
        kill();
        waitpid(pid_, nullptr, 0);
      }
      std::this_thread::sleep_for(10ms);
    }
  }
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void SpawnedServer::kill() {
  if (pid_ > 0) ::kill(pid_, SIGKILL);
}

std::string SpawnedServer::lastLine() const {
  std::ifstream file(folder_ / "log");
  std::string line, last = "it ended without a word";
  while (std::getline(file, line))
    if (!line.empty()) last = line;
  return last;
}

}  // namespace helio::load
