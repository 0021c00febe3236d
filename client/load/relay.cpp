#include "load/relay.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

namespace helio::load {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr size_t kChunk = 16 << 10;
constexpr size_t kSegment = 1460;       // bytes of a TCP segment on Ethernet
constexpr size_t kBuffer = 4 << 20;     // under way in one direction; then the sender waits
constexpr auto kRetransmission = 10ms;  // on top of a round trip

Clock::duration milliseconds(double ms) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double, std::milli>(ms));
}

/// One direction of a connection.
class Pipe {
 public:
  Pipe(int from, int to) : from_(from), to_(to) {}

  bool wantsToRead() const { return !end_ && held_ < kBuffer; }
  bool finished() const { return end_ && chunks_.empty(); }
  std::optional<Clock::time_point> due() const {
    if (chunks_.empty()) return std::nullopt;
    return chunks_.front().due;
  }
  bool blocked() const { return blocked_; }  ///< the receiver takes no more now
  int from() const { return from_; }
  int to() const { return to_; }

  /// False: the connection is broken.
  bool read(const Network& network, std::mt19937_64& random) {
    std::string bytes(kChunk, '\0');
    const ssize_t count = recv(from_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0) return errno == EAGAIN || errno == EINTR;
    if (count == 0) {
      end_ = true;
      if (chunks_.empty()) shutdown(to_, SHUT_WR);
      return true;
    }
    bytes.resize(static_cast<size_t>(count));
    const auto now = Clock::now();
    sent_ = std::max(sent_, now);
    if (network.rate_kbps > 0) sent_ += milliseconds(double(bytes.size()) * 8 / network.rate_kbps);
    auto due = sent_ + milliseconds(network.delay_ms);
    std::bernoulli_distribution lost(network.loss);
    for (size_t at = 0; at < bytes.size(); at += kSegment)
      if (network.loss > 0 && lost(random)) {
        due += milliseconds(2 * network.delay_ms) + kRetransmission;
        break;  // segments of one chunk are sent again together
      }
    last_due_ = std::max(last_due_, due);
    held_ += bytes.size();
    chunks_.push_back({last_due_, std::move(bytes)});
    return true;
  }

  /// Sends what is due. False: the connection is broken.
  bool write() {
    blocked_ = false;
    while (!chunks_.empty() && chunks_.front().due <= Clock::now()) {
      const std::string& bytes = chunks_.front().bytes;
      const ssize_t count = send(to_, bytes.data() + offset_, bytes.size() - offset_, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count < 0) {
        blocked_ = errno == EAGAIN;
        return blocked_ || errno == EINTR;
      }
      offset_ += static_cast<size_t>(count);
      held_ -= static_cast<size_t>(count);
      if (offset_ < bytes.size()) continue;
      chunks_.pop_front();
      offset_ = 0;
    }
    if (finished()) shutdown(to_, SHUT_WR);
    return true;
  }

 private:
  struct Chunk {
    Clock::time_point due;
    std::string bytes;
  };
  const int from_, to_;
  std::deque<Chunk> chunks_;
  size_t offset_ = 0, held_ = 0;
  Clock::time_point sent_{}, last_due_{};
  bool end_ = false, blocked_ = false;
};

int connectTo(const std::string& address, int family) {
  const int fd = socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return fd;
  if (connect(fd, reinterpret_cast<const sockaddr*>(address.data()), static_cast<socklen_t>(address.size())) == 0)
    return fd;
  close(fd);
  return -1;
}

}  // namespace

struct Relay::Link {
  Link(int client, int server) : client(client), server(server), up(client, server), down(server, client) {}
  ~Link() {
    // A reset, not an orderly end: so is a client that was killed.
    const linger reset{1, 0};
    for (const int fd : {client, server}) {
      if (!up.finished() || !down.finished()) setsockopt(fd, SOL_SOCKET, SO_LINGER, &reset, sizeof reset);
      close(fd);
    }
  }
  const int client, server;
  Pipe up, down;
  bool frozen = false, broken = false;
};

Relay::Relay(const Network& network, uint64_t seed) : network_(network), random_(seed) {}

Result<std::unique_ptr<Relay>> Relay::start(const std::string& server, const Network& network, uint64_t seed) {
  const auto failed = [&](const std::string& what) {
    return Error{ErrorKind::unavailable, "the relay to " + server + ": " + what, "server", server, {}};
  };
  const size_t colon = server.rfind(':');
  if (colon == std::string::npos) return failed("give host:port");
  std::string host = server.substr(0, colon);
  if (host.size() > 2 && host.front() == '[') host = host.substr(1, host.size() - 2);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), server.c_str() + colon + 1, &hints, &found))
    return failed(gai_strerror(error));
  std::unique_ptr<Relay> relay(new Relay(network, seed));
  relay->server_address_.assign(reinterpret_cast<const char*>(found->ai_addr), found->ai_addrlen);
  relay->server_family_ = found->ai_family;
  freeaddrinfo(found);

  relay->listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  relay->wake_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof here;
  auto* address = reinterpret_cast<sockaddr*>(&here);
  if (relay->wake_ < 0 || bind(relay->listener_, address, length) != 0 || listen(relay->listener_, 16) != 0 ||
      getsockname(relay->listener_, address, &length) != 0)
    return failed(std::string("no port to listen on: ") + std::strerror(errno));
  relay->address_ = "127.0.0.1:" + std::to_string(ntohs(here.sin_port));
  relay->thread_ = std::thread([raw = relay.get()] { raw->run(); });
  return relay;
}

Relay::~Relay() {
  if (thread_.joinable()) {
    command(kEnd);
    thread_.join();
  }
  for (const int fd : {listener_, wake_})
    if (fd >= 0) close(fd);
}

/// Returns when it is done: what the client says next must not get through.
void Relay::command(Command command) {
  commands_ |= command;
  const uint64_t one = 1;
  if (::write(wake_, &one, sizeof one) < 0) return;  // cannot be: the counter holds 2^64 - 2
  for (unsigned left = commands_; left & command; left = commands_) commands_.wait(left);
}

void Relay::accept() {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (client < 0) return;
  const int server = connectTo(server_address_, server_family_);
  if (server < 0) {
    close(client);
    return;
  }
  const int yes = 1;
  for (const int fd : {client, server}) setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  links_.push_back(std::make_unique<Link>(client, server));
}

void Relay::run() {
  for (;;) {
    std::vector<pollfd> fds = {{listener_, POLLIN, 0}, {wake_, POLLIN, 0}};
    std::optional<Clock::time_point> next;
    for (const auto& link : links_) {
      if (link->frozen) continue;
      for (const Pipe* pipe : {&link->up, &link->down}) {
        fds.push_back({pipe->wantsToRead() ? pipe->from() : -1, POLLIN, 0});
        fds.push_back({pipe->blocked() ? pipe->to() : -1, POLLOUT, 0});
        if (const auto due = pipe->due(); due && !pipe->blocked()) next = next ? std::min(*next, *due) : *due;
      }
    }
    timespec wait{};
    if (next) {
      const auto left = std::max<Clock::duration>(*next - Clock::now(), 0ns);
      wait = {static_cast<time_t>(left / 1s), static_cast<long>((left % 1s) / 1ns)};
    }
    ppoll(fds.data(), fds.size(), next ? &wait : nullptr, nullptr);

    uint64_t ignored;
    if (fds[1].revents && ::read(wake_, &ignored, sizeof ignored) < 0) continue;
    const unsigned commands = commands_;
    if (commands & kEnd) break;
    size_t index = 2;
    for (const auto& link : links_) {
      if (link->frozen) continue;
      for (Pipe* pipe : {&link->up, &link->down}) {
        if (fds[index].revents && !pipe->read(network_, random_)) link->broken = true;
        if (!link->broken && !pipe->write()) link->broken = true;
        index += 2;
      }
    }
    for (const auto& link : links_) {
      if (commands & kFreeze) link->frozen = true;
      if ((commands & kCut) && !link->frozen) link->broken = true;
    }
    links_.remove_if([](const auto& link) {
      return !link->frozen && (link->broken || (link->up.finished() && link->down.finished()));
    });
    commands_ &= ~commands;
    commands_.notify_all();
    if (fds[0].revents) accept();
  }
  links_.clear();
  commands_ = 0;
  commands_.notify_all();
}

}  // namespace helio::load
