// JPEG by TurboJPEG.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "render/renderer.h"

namespace helio::stream {

/// One compressor; used by one thread at a time. Costs 2 to 3 ms for a 720p picture on one core.
class JpegEncoder {
 public:
  JpegEncoder();
  ~JpegEncoder();
  JpegEncoder(const JpegEncoder&) = delete;
  JpegEncoder& operator=(const JpegEncoder&) = delete;

  /// Replaces `out` by a baseline JPEG, 4:2:0. `quality` is [1, 100]. Errors: TurboJPEG's own (internal).
  Result<void> encode(const render::Pixels& pixels, int quality, std::string& out);

 private:
  void* compressor_;
  std::vector<unsigned char> buffer_;  ///< the largest that the pictures so far could have become
};

}  // namespace helio::stream
