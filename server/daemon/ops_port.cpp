#include "daemon/ops_port.h"

#include <httplib.h>

#include <atomic>
#include <charconv>
#include <mutex>
#include <thread>
#include <utility>

namespace helio::daemon {
namespace {

// Health and metrics are asked for by a few machines every few seconds.
constexpr size_t kThreads = 2;
constexpr int kPatienceSeconds = 5;

}  // namespace

struct OpsPort::Parts {
  httplib::Server http;
  std::string address;
  std::mutex mutex;
  Source source;
  std::atomic<bool> ended = false;
  std::thread thread;

  std::string notReady() {
    std::lock_guard lock(mutex);
    return source.not_ready ? source.not_ready() : "starting";
  }
  std::string metrics() {
    std::lock_guard lock(mutex);
    return source.metrics ? source.metrics() : "";
  }
};

OpsPort::OpsPort(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Result<std::unique_ptr<OpsPort>> OpsPort::open(const std::string& address) {
  const auto where = parseAddress("ops-listen", address);
  if (!where) return where.error();
  auto parts = std::make_unique<Parts>();
  auto& http = parts->http;
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_read_timeout(kPatienceSeconds, 0);
  http.set_write_timeout(kPatienceSeconds, 0);
  http.set_keep_alive_max_count(1);  // two threads: nobody keeps one
  http.set_payload_max_length(0);
  // Two servers on one port would share its clients between them, without a word.
  http.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  http.Get("/livez", [](const httplib::Request&, httplib::Response& out) { out.set_content("alive\n", "text/plain"); });
  http.Get("/readyz", [raw = parts.get()](const httplib::Request&, httplib::Response& out) {
    const std::string why = raw->notReady();
    out.status = why.empty() ? 200 : 503;
    out.set_content((why.empty() ? "ready" : why) + "\n", "text/plain");
  });
  http.Get("/metrics", [raw = parts.get()](const httplib::Request&, httplib::Response& out) {
    out.set_content(raw->metrics(), "text/plain; version=0.0.4; charset=utf-8");
  });
  int port = where->port;
  if (port == 0) port = http.bind_to_any_port(where->host.c_str());
  else if (!http.bind_to_port(where->host.c_str(), port)) port = -1;
  if (port < 0)
    return Error{ErrorKind::unavailable,
                 "cannot listen on " + address + " for health and metrics: is something else there already?",
                 "ops-listen",
                 address,
                 {}};
  parts->address = address.substr(0, address.rfind(':')) + ":" + std::to_string(port);
  parts->thread = std::thread([raw = parts.get()] {
    raw->http.listen_after_bind();
    raw->ended = true;
  });
  return std::unique_ptr<OpsPort>(new OpsPort(std::move(parts)));
}

OpsPort::~OpsPort() {
  // stop() does nothing before the loop runs; the loop begins at once.
  while (!parts_->http.is_running() && !parts_->ended) std::this_thread::yield();
  parts_->http.stop();
  parts_->thread.join();
}

const std::string& OpsPort::address() const { return parts_->address; }

void OpsPort::show(Source source) {
  std::lock_guard lock(parts_->mutex);
  parts_->source = std::move(source);
}

Result<HostAndPort> parseAddress(const std::string& flag, const std::string& address) {
  const size_t colon = address.rfind(':');
  HostAndPort out;
  bool good = colon != std::string::npos && colon > 0;
  if (good) {
    const char* end = address.data() + address.size();
    const auto parsed = std::from_chars(address.data() + colon + 1, end, out.port);
    good = parsed.ec == std::errc{} && parsed.ptr == end && out.port >= 0 && out.port <= 65'535;
    out.host = address.substr(0, colon);
    if (out.host.size() > 2 && out.host.front() == '[' && out.host.back() == ']')
      out.host = out.host.substr(1, out.host.size() - 2);
  }
  if (!good)
    return invalid(flag, address, "--" + flag + " is \"" + address + "\"; give host:port, such as 127.0.0.1:9700");
  return out;
}

}  // namespace helio::daemon
