// The whole server: worlds, viewers, telemetry, health and reflection behind one address.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "base/result.h"
#include "render/renderer.h"
#include "scene/city.h"
#include "service/limits.h"
#include "store/edit_log.h"

namespace helio::service {

struct ServerConfig {
  std::string address = "127.0.0.1:7700";  ///< host:port; without keys on the loopback interface; port 0: a free one
  std::filesystem::path keys;        ///< folder of `heliographd init`: TLS, and a token for every call; empty: none
  std::string version;               ///< what GetServerInfo says
  std::string advertise;             ///< host:port that Resolve answers; empty: where the client asked
  std::filesystem::path gltf_root;   ///< worlds may be made of the glTF files in here; empty: of none
  std::filesystem::path price_list;  ///< what presets cost on this machine (service/price_file.h); empty: what comes
                                     ///< with the program
  unsigned encoder_threads = 2;      ///< at least 1; a 720p frame takes a thread 2 to 3 ms
  /// A world's snapshot is written when the records since the last one weigh so much, and as much as it.
  uint64_t snapshot_bytes = 4 << 20;
  Limits limits;
  /// The device is lost, or an invariant broke. Called on a world's thread; the process should end with the message.
  std::function<void(const Error&)> on_fatal;
};

/// The host of "host:port" is this machine alone, by name or number.
bool isLoopback(const std::string& address);

class Server {
 public:
  /// Listens and serves; the worlds of the log are here again, and being loaded. `renderer` and `log` outlive the
  /// server. Errors: the log's; (limit): it holds too many worlds; (invalid): an address that is not loopback without
  /// keys, for then everybody who reaches the port may build and destroy; the keys' (KeyFolder::check); the price
  /// list's (readPriceList); (unavailable): an address in use.
  static Result<std::unique_ptr<Server>> start(ServerConfig config, render::Renderer& renderer, store::EditLog& log);
  /// drain(), unless that was done.
  ~Server();

  /// host:port as bound.
  const std::string& address() const;

  /// What CreateWorld does for a client, before the server counts as ready. Errors likewise, but the world may be
  /// there, made of the same city.
  Result<void> createCity(const std::string& world, const scene::CityParameters& parameters);

  /// Why new clients are not welcome now: starting (the worlds of the log are being loaded), draining. Empty: they are.
  std::string notReady() const;
  /// Prometheus' text format.
  std::string metrics();

  /// Tells every viewer, ends every stream, and gives them `grace` to take it in; then cuts what is left.
  void drain(std::chrono::milliseconds grace = std::chrono::seconds(2));

 private:
  struct Parts;
  explicit Server(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace helio::service
