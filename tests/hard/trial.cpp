#include "hard/trial.h"

#include <algorithm>
#include <cmath>

#include "support/likeness.h"
#include "support/viewed_world.h"

namespace helio::test {
namespace {

constexpr uint32_t kBlock = 8, kSamplesPerTick = 16;
/// Standard errors that a mean may be off beside its tolerance: one in 10^5 is by chance.
constexpr double kDeviations = 4.5;

double red(const render::Frame& frame, uint32_t x, uint32_t y) {
  return static_cast<double>(frame.radiance[3 * (size_t{y} * frame.pixels->width + x)]);
}

/// The error is that of the blocks' means: live pictures decide some things for tiles of pixels.
void estimateMean(Measured& measured, uint32_t size) {
  const uint32_t across = size / kBlock;
  double sum = 0.0, squares = 0.0;
  for (uint32_t block = 0; block < across * across; ++block) {
    double of_block = 0.0;
    for (uint32_t i = 0; i < kBlock * kBlock; ++i)
      of_block += red(measured.frame, block % across * kBlock + i % kBlock, block / across * kBlock + i / kBlock) /
                  (kBlock * kBlock);
    sum += of_block;
    squares += of_block * of_block;
  }
  const double n = across * across;
  measured.mean = sum / n;
  measured.standard_error = std::sqrt(std::max(0.0, squares / n - measured.mean * measured.mean) / (n - 1.0));
}

void judgeTexels(Measured& measured, const HardScene& scene) {
  for (const float radiance : measured.frame.radiance)
    measured.broken_texels += !std::isfinite(radiance) || radiance < 0.0f;
  const double truth = scene.truth.value_or(0.0), unit = truth > 0.0 ? truth : 1.0;
  for (uint32_t y = 0; y < scene.size; ++y)
    for (uint32_t x = 0; x < scene.size; ++x)
      measured.worst_texel = std::max(measured.worst_texel, std::abs(red(measured.frame, x, y) - truth) / unit);
  measured.energy_error = std::max(0.0, measured.mean / std::max(1.0, truth) - 1.0);
  if (scene.truth) measured.error = std::abs(measured.mean - truth) / unit;
}

/// Accumulates in a view that first showed what the scene wants shown before.
Result<void> accumulate(Measured& measured, render::Renderer& renderer, const HardScene& scene,
                        const render::ViewSettings& settings) {
  auto viewed = ViewedWorld::open(renderer, scene.scene);
  if (!viewed) return viewed.error();
  for (const Before& before : scene.before) {
    render::ViewSettings other = settings;
    other.width = other.height = before.size;
    if (auto shown = (*viewed)->tick(before.camera, other, scene.tick_seconds); !shown) return shown.error();
  }
  for (uint32_t done = 0; done < measured.samples; done += settings.samples) {
    auto frame = (*viewed)->tick(scene.camera, settings, scene.tick_seconds);
    if (!frame) return frame.error();
    measured.nonfinite += frame->stats.nonfinite;
    measured.frame = std::move(*frame);
  }
  return {};
}

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", value);
  return buffer;
}

}  // namespace

Result<Measured> measure(render::Renderer& renderer, const HardScene& scene, const Way& way, bool converged) {
  render::ViewSettings settings = referenceSettings(scene.size, scene.size);
  settings.mode = way.mode;
  settings.primary = way.primary;
  settings.bounces = scene.bounces;
  settings.roulette = way.mode == render::Mode::hybrid;
  settings.samples = kSamplesPerTick;
  // The picture, for people: what should be seen is middle grey.
  settings.exposure_ev = scene.truth && *scene.truth > 0.0
                             ? std::clamp(static_cast<float>(std::log2(0.5 / *scene.truth)), -16.0f, 16.0f)
                             : 0.0f;

  Measured measured;
  const uint32_t wanted = converged && scene.converged_samples ? scene.converged_samples : scene.samples;
  measured.samples = (wanted + kSamplesPerTick - 1) / kSamplesPerTick * kSamplesPerTick;
  if (auto done = accumulate(measured, renderer, scene, settings); !done) return done.error();
  estimateMean(measured, scene.size);
  judgeTexels(measured, scene);
  if (scene.twin) {
    HardScene other{scene.twin->scene, scene.twin->camera, scene.bounces, scene.samples};
    other.size = scene.size;
    Measured twin;
    twin.samples = measured.samples;
    if (auto done = accumulate(twin, renderer, other, settings); !done) return done.error();
    measured.nonfinite += twin.nonfinite;
    measured.similarity = structuralSimilarity(*measured.frame.pixels, *twin.frame.pixels);
  }
  return measured;
}

std::vector<std::string> broken(const HardScene& scene, const Measured& measured, bool converged) {
  std::vector<std::string> list;
  if (measured.nonfinite > 0) list.push_back(std::to_string(measured.nonfinite) + " samples were not finite");
  if (measured.broken_texels > 0)
    list.push_back(std::to_string(measured.broken_texels) + " texels are not finite, or negative");
  const double noise = kDeviations * measured.standard_error, truth = scene.truth.value_or(0.0);
  const double most = scene.bound * std::max(1.0, truth) + noise;
  if (!(measured.mean <= most)) list.push_back("the mean is " + text(measured.mean) + ", at most " + text(most));
  const double tolerance = (converged ? std::min(scene.tolerance, kConverged) : scene.tolerance) * truth + noise;
  if (scene.truth && !(std::abs(measured.mean - truth) <= tolerance))
    list.push_back("the mean is " + text(measured.mean) + ", the truth " + text(truth) + " +- " + text(tolerance));
  if (measured.similarity && !(*measured.similarity >= kAlike))
    list.push_back("the similarity to the twin is " + text(*measured.similarity) + ", at least " + text(kAlike));
  return list;
}

}  // namespace helio::test
