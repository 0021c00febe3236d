// Access to the tables of further paths (shared/extra_samples.h).
#ifndef HELIO_EXTRA_SAMPLES_GLSL
#define HELIO_EXTRA_SAMPLES_GLSL
#include "lib/paths.glsl"
#include "shared/extra_samples.h"

layout(buffer_reference, scalar) buffer ExtraSamplesRef { ExtraSamples samples; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer ExtraTileTable { ExtraTile items[]; };

// Pixels that get most paths come first, so that each round's are the list's beginning.
uvec2 extraPixel(uint index) {
  const uint pixel = PathPixelTable(frame.extra_pixels).items[index];
  return uvec2(pixel % frame.width, pixel / frame.width);
}

// The round that `push` names.
uint extraRound() { return push.tick_sample - 1u; }
uint extraPathsOfRound() {
  ExtraSamplesRef extra = ExtraSamplesRef(frame.extra_samples);
  return extra.samples.rounds[extraRound()].paths;
}

uvec2 extraTiles() { return (uvec2(frame.width, frame.height) + kExtraTile - 1u) / kExtraTile; }

// A pixel's kind: the squares of a chess-board.
uint extraKind(uvec2 pixel) { return (pixel.x + pixel.y) & 1u; }

// Deviations and the bins that they are counted in; of bin 0: 0.
uint noiseBin(float deviation) {
  const float steps = float(kNoiseStepsPerOctave) * (log2(max(deviation, 1e-30)) + float(kNoiseOctavesBelowOne));
  return uint(clamp(steps, 0.0, float(kNoiseBins - 1u)));
}
float deviationOf(uint bin) {
  return bin == 0u ? 0.0 : exp2((float(bin) + 0.5) / float(kNoiseStepsPerOctave) - float(kNoiseOctavesBelowOne));
}

// Further paths of a pixel, in the mean: in all it has as many as its deviation calls for [Neyman 1934], and one it has.
float extraPaths(float share, uint bin) { return clamp(share * deviationOf(bin) - 1.0, 0.0, float(kMostExtraPaths)); }

#endif
