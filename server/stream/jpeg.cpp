#include "stream/jpeg.h"

#include <turbojpeg.h>

#include <stdexcept>

namespace helio::stream {

JpegEncoder::JpegEncoder() : compressor_(tjInitCompress()) {
  if (!compressor_) throw std::runtime_error("TurboJPEG gives no compressor: out of memory");
}

JpegEncoder::~JpegEncoder() { tjDestroy(compressor_); }

Result<void> JpegEncoder::encode(const render::Pixels& pixels, int quality, std::string& out) {
  const int width = static_cast<int>(pixels.width), height = static_cast<int>(pixels.height);
  // The largest that this size can become: nothing is allocated or copied by the encoder.
  out.resize(tjBufSize(width, height, TJSAMP_420));
  auto* bytes = reinterpret_cast<unsigned char*>(out.data());
  unsigned long size = out.size();
  const int pitch = 0;  // no padding between rows
  if (tjCompress2(compressor_, pixels.rgbx, width, pitch, height, TJPF_RGBX, &bytes, &size, TJSAMP_420, quality,
                  TJFLAG_NOREALLOC) != 0)
    return Error{ErrorKind::internal, std::string("JPEG encoder: ") + tjGetErrorStr2(compressor_), {}, {}, {}};
  out.resize(size);
  return {};
}

}  // namespace helio::stream
