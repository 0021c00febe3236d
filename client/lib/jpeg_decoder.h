// Frames back into pixels, by TurboJPEG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace helio::client {

/// One decompressor; used by one thread at a time.
class JpegDecoder {
 public:
  JpegDecoder();
  ~JpegDecoder();
  JpegDecoder(const JpegDecoder&) = delete;
  JpegDecoder& operator=(const JpegDecoder&) = delete;

  struct Image {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgbx;  ///< 4 bytes a pixel, rows top-down
  };
  /// Into `image`, whose memory is used again. Errors (invalid): the bytes are no JPEG.
  Result<void> decode(const std::string& jpeg, Image& image);

 private:
  void* decompressor_;
};

}  // namespace helio::client
