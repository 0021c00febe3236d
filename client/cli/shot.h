// What a shot is asked to be, whether a server renders it or this process.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"

namespace helio::cli {

inline constexpr uint32_t kShotSamples = 16;

struct ShotOptions : Viewpoint {
  std::string world, out = "shot.png", size = "640x360", mode = "reference", primary = "raster", materials = "none";
  std::optional<uint32_t> samples;  ///< a pixel; unset: kShotSamples, or the spec's
  uint32_t bounces = 3;
  float exposure_ev = 0;
  bool fixed_exposure = false;
  int quality = 90;
  v1::LightTransport light;
  Approximations approximations;
  // --local only
  bool local = false, validation = false;
  uint32_t city = 0, animated = 0;
  double time = 0;  ///< of the world, seconds
  uint64_t seed = 1;
  std::string gltf, spec, device;
  std::optional<double> sun_elevation;
  double sun_azimuth = 150;
};

struct ShotResult {
  std::string bytes;
  uint32_t samples = 0;
  double gpu_ms = 0, exposure = 1;
  uint64_t rays = 0;
};

/// From the end of the file's name: .png, .jpg, .jpeg or .pfm.
v1::Codec codecOf(const std::string& file);

ShotResult shootLocally(ShotOptions options);

}  // namespace helio::cli
