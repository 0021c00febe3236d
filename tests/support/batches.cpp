#include "support/batches.h"

namespace helio::test {

Batches renderBatches(Stage& stage, const scene::Camera& camera, const render::ViewSettings& settings,
                      uint32_t batches) {
  Batches result;
  std::vector<double> before;  // sum of the batches so far
  for (uint32_t k = 1; k <= batches; ++k) {
    const render::Frame frame = stage.tick(camera, settings);
    EXPECT_EQ(frame.stats.nonfinite, 0u);
    EXPECT_EQ(frame.stats.accumulated, k * settings.samples);
    // The picture is the mean of all samples so far: take what is new.
    before.resize(frame.radiance.size());
    std::vector<double> batch(frame.radiance.size());
    for (size_t i = 0; i < batch.size(); ++i) {
      const double sum = static_cast<double>(k) * static_cast<double>(frame.radiance[i]);
      batch[i] = sum - before[i];
      before[i] = sum;
    }
    result.push_back(std::move(batch));
  }
  return result;
}

Batches channel(const Batches& rgb, size_t c) {
  Batches result;
  for (const std::vector<double>& batch : rgb) {
    std::vector<double>& values = result.emplace_back();
    for (size_t i = c; i < batch.size(); i += 3) values.push_back(batch[i]);
  }
  return result;
}

Batches luminance(const Batches& rgb) {
  Batches result;
  for (const std::vector<double>& batch : rgb) {
    std::vector<double>& values = result.emplace_back();
    for (size_t i = 0; i + 2 < batch.size(); i += 3)
      values.push_back(0.2126 * batch[i] + 0.7152 * batch[i + 1] + 0.0722 * batch[i + 2]);
  }
  return result;
}

}  // namespace helio::test
