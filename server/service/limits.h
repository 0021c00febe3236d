// What one server allows. Each limit says why it is there; GetServerInfo tells clients.
#pragma once

#include <cstdint>

#include "world/world.h"

namespace helio::service {

struct Limits {
  uint32_t max_worlds = 16;   ///< each has a scene in memory and on the GPU, and a thread
  uint32_t max_viewers = 64;  ///< viewers and running shots over all worlds: each has render targets on the GPU
  world::Limits world;        ///< instances and edits: the TLAS and the log must hold them
  uint32_t max_request_bytes =
      8 << 20;               ///< 100,000 placements are 3.2 MB; a request is held in memory while it is checked
  uint32_t min_size = 16;    ///< pixels; below, tile-based passes have nothing to do
  uint32_t max_size = 8192;  ///< pixels; the render targets of one 8192 x 8192 view take some 5 GB
  uint32_t max_fps = 60;     ///< for one viewer; screens rarely show more, and every frame costs everybody's GPU
  uint32_t max_shot_samples = 65'536;          ///< a pixel; float running means stop gaining digits about there
  uint64_t max_accuracy_pixels = 3840 * 2160;  ///< of a compared picture; FLIP holds some 250 bytes a pixel
  uint32_t max_edits_per_second =
      1'000'000;  ///< with placements, of one world: edits lengthen the ticks of all who look
  uint32_t max_streams_per_connection = 100;  ///< calls at a time: more wait at the client; one connection, one share
  uint64_t max_scene_bytes = 4ull << 30;      ///< of a glTF file with what lies beside it: it is read into memory
  uint32_t resume_seconds =
      30;  ///< that a broken viewer's render targets are kept for its return; they fill the device
  uint32_t max_silence_seconds = 20;  ///< that a viewer may owe an acknowledgement: then its client is dead
  uint32_t max_name_length = 64;      ///< of worlds and request ids: they are keys in logs and metadata
};

}  // namespace helio::service
