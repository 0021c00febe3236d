#include "stream/jpeg.h"

#include <turbojpeg.h>

#include <algorithm>
#include <stdexcept>

namespace helio::stream {

JpegEncoder::JpegEncoder() : compressor_(tjInitCompress()) {
  if (!compressor_) throw std::runtime_error("TurboJPEG gives no compressor: out of memory");
}

JpegEncoder::~JpegEncoder() { tjDestroy(compressor_); }

Result<void> JpegEncoder::encode(const render::Pixels& pixels, int quality, std::string& out) {
  const int width = static_cast<int>(pixels.width), height = static_cast<int>(pixels.height);
  // The largest that this size can become, touched once: to give each message so much room for a picture of a tenth of
  // it costs more than the copy, in fresh pages.
  buffer_.resize(std::max<size_t>(buffer_.size(), tjBufSize(width, height, TJSAMP_420)));
  unsigned char* bytes = buffer_.data();
  unsigned long size = buffer_.size();
  const int pitch = 0;  // no padding between rows
  if (tjCompress2(compressor_, pixels.rgbx, width, pitch, height, TJPF_RGBX, &bytes, &size, TJSAMP_420, quality,
                  TJFLAG_NOREALLOC) != 0)
    return Error{ErrorKind::internal, std::string("JPEG encoder: ") + tjGetErrorStr2(compressor_), {}, {}, {}};
  out.assign(reinterpret_cast<const char*>(bytes), size);
  return {};
}

}  // namespace helio::stream
