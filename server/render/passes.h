// All passes of a view, one object each, shared by all worlds.
#pragma once

#include "render/passes/accumulate.h"
#include "render/passes/asvgf.h"
#include "render/passes/bare_trace.h"
#include "render/passes/culling_view.h"
#include "render/passes/error_estimate.h"
#include "render/passes/exposure.h"
#include "render/passes/extra_samples.h"
#include "render/passes/inspect.h"
#include "render/passes/learn_lamps.h"
#include "render/passes/motion.h"
#include "render/passes/occlusion.h"
#include "render/passes/path_trace.h"
#include "render/passes/primary_raster.h"
#include "render/passes/primary_traced.h"
#include "render/passes/reblur.h"
#include "render/passes/reconstruct.h"
#include "render/passes/shadow_map.h"
#include "render/passes/statistics.h"
#include "render/passes/sunlight.h"
#include "render/passes/svgf.h"
#include "render/passes/taa.h"
#include "render/passes/tonemap.h"

namespace helio::render {

struct Passes {
  explicit Passes(gpu::Device& device)
      : culling(device),
        primary_raster(device),
        shadow_map(device),
        primary_traced(device),
        motion(device),
        path_trace(device),
        extra_samples(device),
        reconstruct(device),
        learn_lamps(device),
        accumulate(device),
        sunlight(device),
        occlusion(device),
        statistics(device),
        error_estimate(device),
        exposure(device),
        tonemap(device),
        svgf(device),
        asvgf(device),
        reblur(device),
        taa(device),
        inspect(device),
        culling_view(device),
        bare_trace(device) {}

  /// Null: light stays as it was sampled.
  const DenoiserPasses* denoiser(Denoiser which) const {
    switch (which) {
      case Denoiser::none:
        return nullptr;
      case Denoiser::svgf:
        return &svgf;
      case Denoiser::asvgf:
        return &asvgf;
      case Denoiser::reblur:
        return &reblur;
    }
    return nullptr;
  }

  CullPipelines culling;
  PrimaryRaster primary_raster;
  ShadowMapPass shadow_map;
  PrimaryTraced primary_traced;
  Motion motion;
  PathTrace path_trace;
  ExtraSamplesPass extra_samples;
  Reconstruct reconstruct;
  LearnLamps learn_lamps;
  Accumulate accumulate;
  Sunlight sunlight;
  Occlusion occlusion;
  Statistics statistics;
  ErrorEstimate error_estimate;
  Exposure exposure;
  Tonemap tonemap;
  Svgf svgf;
  Asvgf asvgf;
  Reblur reblur;
  Taa taa;
  InspectPass inspect;
  CullingViewPass culling_view;
  BareTrace bare_trace;
};

}  // namespace helio::render
