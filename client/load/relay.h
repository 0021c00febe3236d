// A bad network on loopback: bytes between a client and a server are delayed, held to a rate, lost and sent again, or
// not carried any more.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <list>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "base/result.h"
#include "load/scenario.h"

namespace helio::load {

/// Listens on a free port of 127.0.0.1 and carries each connection to the server. One thread, which sleeps while
/// nothing is due.
///
/// TCP itself never loses a byte. What a loss does to it is that everything behind the lost segment waits until it was
/// sent again: the relay holds the stream back by a round trip and 10 ms, as fast retransmission does. That a sender
/// slows down after a loss is not modelled.
class Relay {
 public:
  /// `server`: host:port. Errors: the server's name is unknown, or no port is free (unavailable).
  static Result<std::unique_ptr<Relay>> start(const std::string& server, const Network& network, uint64_t seed);
  /// Cuts what is left.
  ~Relay();

  /// Where clients connect to: 127.0.0.1:port.
  const std::string& address() const { return address_; }

  // Both hold for the connections of now, not for later ones. Any thread calls them.
  /// Cuts them: the server reads a reset, as when a client's process is killed.
  void cut() { command(kCut); }
  /// Carries nothing any more and closes nothing, as when a client's machine loses its power.
  void freeze() { command(kFreeze); }

 private:
  enum Command : unsigned { kCut = 1, kFreeze = 2, kEnd = 4 };
  struct Link;

  Relay(const Network& network, uint64_t seed);
  void command(Command command);
  void run();
  void accept();

  const Network network_;
  std::mt19937_64 random_;
  std::string address_;
  std::string server_address_;  ///< a sockaddr
  int server_family_ = 0;
  int listener_ = -1, wake_ = -1;
  std::atomic<unsigned> commands_ = 0;
  std::list<std::unique_ptr<Link>> links_;
  std::thread thread_;
};

}  // namespace helio::load
