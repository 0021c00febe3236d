// Pictures of the renderer in independent batches, for tests of hypotheses.
#pragma once

#include "support/hypothesis.h"
#include "support/stage.h"

namespace helio::test {

/// `batches` pictures with samples of their own (the k-th of any stage has the same), settings.samples paths a pixel
/// each; three values a texel, rows top-down. Reference mode, still camera. Fails the test when a sample was not
/// finite.
Batches renderBatches(Stage& stage, const scene::Camera& camera, const render::ViewSettings& settings,
                      uint32_t batches);

/// One of the three values of each texel, and their Rec. 709 luminance.
Batches channel(const Batches& rgb, size_t c);
Batches luminance(const Batches& rgb);

}  // namespace helio::test
