// Pass `path_trace`: one path a pixel from the primary hits on, specialised for the effects that the scene calls for.
// In several launches, each over the paths that are still alive.
#pragma once

#include <map>
#include <mutex>
#include <tuple>

#include "gpu/pipelines.h"
#include "render/passes/pass.h"
#include "render/passes/statistics.h"

namespace helio::render {

/// The ray tracing pipeline of a ray generation shader that uses shaders/lib/trace.glsl. `constants`: those of
/// `effects`, and more.
gpu::RayTracingDescription describeTrace(const std::string& raygen, effects::EffectSet effects,
                                         const gpu::Specialisation& constants);
/// What decides whether a ray meets a surface; empty: it does.
std::string anyHit(effects::EffectSet effects);

class PathTrace {
 public:
  explicit PathTrace(gpu::Device& device);

  /// A variant that was never used takes up to a second to compile: worlds warm up what their prefabs could call for.
  void add(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects);
  /// Pass `extra_paths`: the further paths that `extra_samples` has listed, with their rays in the statistics.
  /// `sample`: the tick's own, whose primary hits are in the visibility image.
  void addExtra(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects,
                const Statistics& statistics);
  /// Pass `log_rays`: traces the same paths again and only writes down their rays (for `bare_trace`).
  void addLog(const ViewPass& pass, const shared::SampleConstants& sample, effects::EffectSet effects);

  /// Most vertices of a path with up to `bounces` + 1 scatterings, the camera's aside: the last one only shines.
  static uint32_t vertices(uint32_t bounces) { return bounces + 2; }
  /// In how many launches the vertices are traced.
  uint32_t launches(const ViewSettings& settings) const;
  /// Most rays that one path may trace, and the end mark.
  static uint32_t rayLogStride(uint32_t bounces) { return (bounces + 1) * 3 + 1; }

 private:
  /// One of every pixel, further ones of pixels that are listed, and those again whose rays are written down.
  enum class Paths { first, further, logged };
  const gpu::RayTracingPipeline& variant(effects::EffectSet effects, const ViewSettings& settings, Paths paths,
                                         bool count_hits, bool any_hit_boxes, bool light_feedback);
  /// What a sample's launches touch.
  static std::vector<Access> accesses(const ViewPass& pass);
  /// All launches of a sample, with the compaction of paths between them.
  void record(gpu::Commands& commands, const gpu::RayTracingPipeline& pipeline, const View& view,
              const PathQueue& paths, shared::SampleConstants sample) const;

  gpu::Device& device_;
  gpu::ComputePipeline compact_;
  std::mutex mutex_;
  std::map<gpu::Specialisation, gpu::RayTracingPipeline> variants_;  // of path_trace.rgen
};

}  // namespace helio::render
