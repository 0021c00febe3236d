// Pictures that benchmarks read and show; server/render/metrics/ says how far apart two of them are.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "render/metrics/image.h"

namespace helio::bench {

using namespace metrics;

/// A colour PFM of either byte order. Errors: not_found, invalid.
Result<Image> readPfm(const std::string& path);

/// As relativeMse(), but the median over pixels, each the mean of its channels: blind to a few bright outliers.
double medianRelativeSquare(const Image& a, const Image& b);

/// Share, 0 to 1, of relativeMse's sum that the worst `fraction` of the pixels hold.
double shareOfWorst(const Image& a, const Image& b, double fraction);

/// As ssim() sees it, but in colour: scaled so that the mean luminance of `exposure` is middle grey, compressed,
/// encoded; four bytes a pixel.
std::vector<uint8_t> tonemapped(const Image& image, const Image& exposure);

/// Signed relative difference as a picture: grey where equal, redder where `a` is brighter, bluer where darker; full
/// colour at `scale`.
std::vector<uint8_t> differencePicture(const Image& a, const Image& b, double scale);

/// Into a folder that is there: NAME.png, exposed as `truth` is, and NAME.error.png: redder where it is brighter than
/// `truth`, bluer where darker, full colour at 10 %.
Result<void> writePictures(const std::string& folder, const std::string& name, const Image& image, const Image& truth);

}  // namespace helio::bench
