// A renderer that costs next to nothing, for measuring and testing the service: no device, no scene, and pictures that
// say what they show, even after JPEG.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>

#include "render/renderer.h"

namespace helio::service {

struct SyntheticOptions {
  std::chrono::microseconds frame_time{0};  ///< a tick takes so long, however many views it has
  uint32_t noise = 0;                       ///< [0, 100]: grey levels by which pixels differ at random; costs bandwidth
};

/// What a picture says, in black and white blocks as large as the picture allows. Numbers are modulo 2^32.
struct Painted {
  uint32_t seq = 0;     ///< the newest edit that it shows
  uint32_t tick = 0;    ///< of the world
  uint32_t camera = 0;  ///< cameraCode() of the camera
};

/// A number for where a camera stands: pictures can be told apart by it, and compared with the camera that was sent.
/// (Renderers are not told the numbers that clients give their cameras.)
uint32_t cameraCode(const glm::vec3& position);

/// Reads a picture of the synthetic renderer, compressed or not. None: it is none, or too much of it was lost. JPEG
/// keeps blocks of 4 pixels and more, which pictures of 64 x 32 pixels and more have.
std::optional<Painted> readPainted(const render::Pixels& pixels);

/// Thread-safe; worlds do not wait for each other.
std::unique_ptr<render::Renderer> makeSyntheticRenderer(const SyntheticOptions& options);

}  // namespace helio::service
