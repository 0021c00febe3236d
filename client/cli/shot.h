// What a shot is asked to be, whether a server renders it or this process.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"

namespace helio::cli {

struct ShotOptions {
  std::string world, camera, out = "shot.png", size = "640x360", mode = "reference", primary = "raster";
  std::vector<float> position, target;
  double vfov = 50;  ///< degrees
  uint32_t samples = 16, bounces = 3;
  float exposure_ev = 0;
  bool fixed_exposure = false;
  int quality = 90;
  // --local only
  bool local = false, validation = false;
  uint32_t city = 0;
  uint64_t seed = 1;
  std::string gltf, device;
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

ShotResult shootLocally(const ShotOptions& options);

}  // namespace helio::cli
