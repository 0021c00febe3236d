#include "stream/jpeg.h"

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "stream/encoder_pool.h"
#include "stream/picture.h"

namespace helio::stream {
namespace {

struct Picture {
  std::vector<uint8_t> rgbx;
  render::Pixels pixels;

  Picture(uint32_t width, uint32_t height) : rgbx(size_t{width} * height * 4) {
    // Flat quadrants: 4:2:0 and the quantiser keep flat colours within a few levels, away from the edges.
    for (uint32_t y = 0; y < height; ++y)
      for (uint32_t x = 0; x < width; ++x) {
        const uint8_t colour[4] = {uint8_t(x < width / 2 ? 200 : 30), uint8_t(y < height / 2 ? 180 : 60), 90, 255};
        std::memcpy(&rgbx[(size_t{y} * width + x) * 4], colour, 4);
      }
    pixels = {rgbx.data(), width, height};
  }
};

std::vector<uint8_t> decode(const std::string& jpeg, int& width, int& height, int& subsampling) {
  const tjhandle handle = tjInitDecompress();
  const auto* bytes = reinterpret_cast<const unsigned char*>(jpeg.data());
  int colourspace = 0;
  EXPECT_EQ(tjDecompressHeader3(handle, bytes, jpeg.size(), &width, &height, &subsampling, &colourspace), 0);
  std::vector<uint8_t> rgbx(size_t(width) * size_t(height) * 4);
  EXPECT_EQ(tjDecompress2(handle, bytes, jpeg.size(), rgbx.data(), width, 0, height, TJPF_RGBX, 0), 0);
  tjDestroy(handle);
  return rgbx;
}

class JpegSizes : public testing::TestWithParam<std::pair<uint32_t, uint32_t>> {};

TEST_P(JpegSizes, DecodesToThePaintedPixels) {
  const auto [w, h] = GetParam();
  const Picture picture(w, h);
  JpegEncoder encoder;
  std::string jpeg = "what was there before";
  ASSERT_TRUE(encoder.encode(picture.pixels, 90, jpeg));
  int width = 0, height = 0, subsampling = 0;
  const auto decoded = decode(jpeg, width, height, subsampling);
  ASSERT_EQ(width, int(w));
  ASSERT_EQ(height, int(h));
  EXPECT_EQ(subsampling, TJSAMP_420);
  for (const auto& [x, y] : {std::pair{w / 8, h / 8}, {w * 7 / 8, h / 8}, {w / 8, h * 7 / 8}, {w * 7 / 8, h * 7 / 8}})
    for (int c = 0; c < 3; ++c) {
      const size_t i = (size_t{y} * w + x) * 4 + size_t(c);
      EXPECT_NEAR(decoded[i], picture.rgbx[i], 6) << "x " << x << " y " << y << " channel " << c;
    }
}

// Odd sizes and sizes that are no multiple of a block of 16.
INSTANTIATE_TEST_SUITE_P(Sizes, JpegSizes,
                         testing::Values(std::pair{64u, 64u}, std::pair{321u, 181u}, std::pair{1280u, 720u}));

TEST(Jpeg, HigherQualityTakesMoreBytes) {
  Picture picture(256, 256);
  uint32_t state = 1;
  for (auto& byte : picture.rgbx) byte = uint8_t((state = state * 1664525u + 1013904223u) >> 24);
  JpegEncoder encoder;
  std::string coarse, fine;
  ASSERT_TRUE(encoder.encode(picture.pixels, 20, coarse));
  ASSERT_TRUE(encoder.encode(picture.pixels, 95, fine));
  EXPECT_LT(coarse.size() * 2, fine.size());
}

TEST(Jpeg, AnImpossibleSizeIsAnError) {
  JpegEncoder encoder;
  std::string out;
  const uint8_t pixel[4] = {};
  const auto result = encoder.encode({pixel, 70'000, 1}, 80, out);  // JPEG's sizes have 16 bits
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::internal);
}

TEST(Picture, PngHasItsSignatureAndSize) {
  const Picture picture(37, 19);
  const auto png = encodePng(picture.pixels);
  ASSERT_TRUE(png);
  EXPECT_EQ(png->substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(uint8_t((*png)[19]), 37);  // IHDR width, big-endian, ends at byte 19
  EXPECT_EQ(uint8_t((*png)[23]), 19);
}

TEST(Picture, PfmHasItsRowsBottomUp) {
  const std::vector<float> radiance = {1, 2, 3, 4, 5, 6};  // one column, two rows
  const std::string pfm = encodePfm(radiance, 1, 2);
  const std::string header = "PF\n1 2\n-1.0\n";
  ASSERT_EQ(pfm.size(), header.size() + 24);
  EXPECT_EQ(pfm.substr(0, header.size()), header);
  float rows[6];
  std::memcpy(rows, pfm.data() + header.size(), 24);
  EXPECT_EQ(std::vector<float>(rows, rows + 6), (std::vector<float>{4, 5, 6, 1, 2, 3}));
}

TEST(EncoderPool, DoesEveryJobBeforeItEnds) {
  std::atomic<int> done = 0;
  {
    EncoderPool pool(3);
    for (int i = 0; i < 100; ++i)
      pool.submit([&](JpegEncoder& encoder) {
        const Picture picture(16, 16);
        std::string out;
        if (encoder.encode(picture.pixels, 80, out)) ++done;
      });
  }
  EXPECT_EQ(done, 100);
}

}  // namespace
}  // namespace helio::stream
