// What all commands of helio share.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "lib/connection.h"
#include "render/renderer.h"

namespace helio::cli {

namespace v1 = heliograph::v1;

/// Keeps the order in which fields are put in: people read the output too.
using Json = nlohmann::ordered_json;

/// Flags of every command.
struct Common {
  std::string server;  ///< host:port; see usualServer()
  bool json = false;
};

/// Thrown by commands, caught by main: one line on standard error, exit status 1.
struct Stop {
  std::string message;
};

/// The value, or Stop with the error's message.
template <typename T>
T get(Result<T> result) {
  if (!result) throw Stop{result.error().message};
  return std::move(*result);
}
inline void get(Result<void> result) {
  if (!result) throw Stop{result.error().message};
}

/// "640x360". Stops on anything else.
struct Size {
  uint32_t width = 640, height = 360;
};
Size parseSize(const std::string& text);

/// "raster" or "traced"; "hybrid" or "reference".
v1::PrimaryHits parsePrimary(const std::string& text);
v1::RenderMode parseMode(const std::string& text);

/// Adds --materials, one of render::materialOverrideNames(), to a command.
void addMaterials(CLI::App& command, std::string& materials);
v1::MaterialOverride parseMaterials(const std::string& text);

/// Adds the switches of light transport to a command: --mis, --no-mis, ..., --regularisation. What is not given stays
/// unset.
void addLightTransport(CLI::App& command, v1::LightTransport& light);

/// Approximations of hybrid mode, and what is shown in the picture's place, as command lines name them
/// (render/choices.h).
struct Approximations {
  std::string sun_shadow = "rays", denoiser = "none", inspect = "nothing", culling_view = "none";
  std::string technique = "path_traced", ambient = "none", indirect_rate = "full", reconstruction = "reuse";
  float ambient_radius = 10.0f, aperture = 0.0f, focus = 10.0f, extra_samples = 0.0f;
  uint32_t shadow_map_size = 2048;
  bool levels_of_detail = true, taa = false;

  /// For v1::Settings and v1::RenderRequest.
  template <typename Message>
  void put(Message& message) const {
    *message.mutable_approximations() = toWire();
    message.set_inspect(inspectOnWire());
    message.set_culling_view(cullingViewOnWire());
    *message.mutable_lens() = lensOnWire();
  }
  /// For this process's own renderer.
  void put(render::ViewSettings& settings) const;

 private:
  v1::Approximations toWire() const;
  v1::Inspect inspectOnWire() const;
  v1::CullingView cullingViewOnWire() const;
  v1::Lens lensOnWire() const;
};
void addApproximations(CLI::App& command, Approximations& approximations);

/// Where a picture that the server makes looks from.
struct Viewpoint {
  std::string camera;                   ///< one of the world's by name; with neither, the server chooses
  std::vector<float> position, target;  ///< metres, three numbers each, or none
  double vfov = 50;                     ///< degrees, with `position`

  /// For v1::RenderRequest and v1::AccuracyRequest.
  template <typename Message>
  void put(Message& message) const {
    if (!position.empty()) *message.mutable_camera() = toWire();
    else if (!camera.empty()) message.set_camera_name(camera);
  }

 private:
  v1::Camera toWire() const;
};

/// Prints a document with its schema.
void print(const Json& document);

/// Writes a whole file. Stops when it cannot.
void writeFile(const std::string& path, const std::string& bytes);

double radians(double degrees);

/// The server that was logged in to last, or else the one that heliographd is without flags.
std::string usualServer();

/// Adds --server and --json to a command.
void addCommon(CLI::App& command, Common& common, bool json = true);

// Each adds one command; what it does runs when it was parsed.
void addWorlds(CLI::App& app, Common& common);
void addPrefabs(CLI::App& app, Common& common);
void addEdit(CLI::App& app, Common& common);
void addShot(CLI::App& app, Common& common);
void addView(CLI::App& app, Common& common);
void addAccuracy(CLI::App& app, Common& common);
void addTop(CLI::App& app, Common& common);
void addLogin(CLI::App& app, Common& common);
void addToken(CLI::App& app, Common& common);

}  // namespace helio::cli
