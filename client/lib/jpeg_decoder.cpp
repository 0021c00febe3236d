#include "lib/jpeg_decoder.h"

#include <turbojpeg.h>

#include <stdexcept>

namespace helio::client {

JpegDecoder::JpegDecoder() : decompressor_(tjInitDecompress()) {
  if (!decompressor_) throw std::runtime_error("TurboJPEG gives no decompressor: out of memory");
}

JpegDecoder::~JpegDecoder() { tjDestroy(decompressor_); }

Result<void> JpegDecoder::decode(const std::string& jpeg, Image& image) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(jpeg.data());
  int width = 0, height = 0, subsampling = 0, colourspace = 0;
  const auto failed = [&] {
    return Error{ErrorKind::invalid, std::string("JPEG decoder: ") + tjGetErrorStr2(decompressor_), "data", {}, {}};
  };
  if (tjDecompressHeader3(decompressor_, bytes, jpeg.size(), &width, &height, &subsampling, &colourspace) != 0)
    return failed();
  image.width = static_cast<uint32_t>(width);
  image.height = static_cast<uint32_t>(height);
  image.rgbx.resize(size_t{image.width} * image.height * 4);
  const int pitch = 0;  // no padding between rows
  if (tjDecompress2(decompressor_, bytes, jpeg.size(), image.rgbx.data(), width, pitch, height, TJPF_RGBX, 0) != 0)
    return failed();
  return {};
}

}  // namespace helio::client
