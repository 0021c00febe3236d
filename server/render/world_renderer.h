// One world on the GPU: its scene, its instances, its acceleration structure, its views. A tick is one submission a
// queue, or a few.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "accel/detail.h"
#include "accel/instance_table.h"
#include "accel/lipac.h"
#include "accel/own_blases.h"
#include "accel/shared_blases.h"
#include "accel/strategy.h"
#include "accel/tlas_assembly.h"
#include "accel/units.h"
#include "accel/viewer_quorum.h"
#include "effects/registry.h"
#include "render/draw_table.h"
#include "render/emitter_instances.h"
#include "render/light_lists.h"
#include "render/passes.h"
#include "render/path_queue.h"
#include "render/renderer.h"
#include "render/scene_resources.h"
#include "render/view.h"

namespace helio::render {

/// Thread-safe: a tick, a view that comes and a view that goes wait for each other.
class WorldRenderer {
 public:
  /// Uploads the scene and warms up the shader variants for what is placed and for what could be built, so that the
  /// first frame waits for no compiler. Throws gpu::Failure.
  WorldRenderer(std::shared_ptr<gpu::Device> device, Passes& passes, scene::ScenePtr scene);

  void addView(ViewHandle handle);
  void removeView(ViewHandle handle);
  /// From the next tick on.
  void setCulling(Culling culling, const CullingSettings& settings);
  void freezeCulling(bool frozen);
  /// Renderer::culledInstances().
  Result<std::vector<CulledInstance>> culledInstances();
  /// Builds BLASes of instances' own one by one. Before the first tick.
  void setOneCallABlas(bool one_by_one) { blas_batch_.setOneCall(!one_by_one); }
  /// Acceleration structures are built beside what is rasterised. Before the first tick; at first, where the device has
  /// a queue for it.
  void setBuildsAside(bool aside) { builds_aside_ = aside; }

  /// One tick (algorithms: apply edits → upload → assemble → build the TLAS → per view: primary hits → path trace →
  /// accumulate → exposure → tonemap → read back). Throws gpu::Failure; the changes are kept for the next tick then.
  Result<std::vector<Frame>> tick(const world::ChangeSet& changes, std::span<const ViewRequest> requests);

 private:
  struct Work;  // what one view's passes need until the graph is recorded
  void warmUp();
  std::vector<Frame> render(const world::ChangeSet& changes, std::span<const ViewRequest> requests, bool scene_changed);
  void addWorldPasses(Graph& graph);
  /// Rasterised primary hits and the sun's shadow map, as far as the view asks for them.
  void addRasterPasses(const ViewPass& pass, const glm::vec2& jitter);
  // Acceleration structures (world_structures.cpp).
  void planStructures(const world::ChangeSet& changes, std::span<const ViewRequest> requests,
                      std::span<const accel::Viewpoint> viewers, bool moved);
  void wantForSights();
  void wantForNewcomers(const world::ChangeSet& changes);
  /// Which units need a BLAS in this tick, the nearest to a viewer first.
  std::vector<accel::WantedUnit> wantedUnits(std::span<const accel::Viewpoint> viewers) const;
  AccelerationUse accelerationUse(const View& view) const;
  // Light path guided culling (world_culling.cpp).
  /// Decides whether it guides this tick; the units that need a BLAS then, the most important first.
  std::vector<accel::WantedUnit> beginCulling(std::span<const ViewRequest> requests,
                                              std::span<const accel::Viewpoint> viewers);
  void uploadCulling(gpu::Commands& commands);
  void addFeedback(Graph& graph, uint64_t tick);
  /// The requests, with the sun's shadow map where culling calls for it.
  std::vector<ViewRequest> castByMap(std::span<const ViewRequest> requests) const;
  /// Of its tiles one in so many counts.
  uint32_t strideOf(const ViewSettings& settings) const;
  void describeCounting(shared::FrameConstants& constants, const View& view) const;
  void addViewPasses(Graph& graph, Work& work);
  void uploadConstants(gpu::Commands& commands, View& view);
  /// Fills in what the view's technique, lens, lamps and histories need (world_lights.cpp).
  void describeTechnique(shared::FrameConstants& constants, View& view) const;
  /// Whether the lists of lamps learn in this tick from what the settings' shadow rays find.
  bool learnsLamps(const ViewSettings& settings) const;
  /// The table of multiple scattering, made for the first view that asks for it.
  VkDeviceAddress ggxAlbedo(gpu::Commands& commands);
  Frame finishView(const Graph& graph, const std::vector<gpu::TimedPass>& times, const Work& work,
                   const world::ChangeSet& changes);
  std::vector<EffectCost> effectCosts(const std::vector<PassTime>& passes) const;

  std::shared_ptr<gpu::Device> device_;
  Passes& passes_;
  scene::ScenePtr scene_;
  gpu::Commands commands_, async_;
  bool builds_aside_ = false;  // on async_
  SceneResources resources_;
  accel::InstanceTable instances_;
  accel::ClipTable clips_;
  accel::Units units_;
  accel::BuildBudget build_budget_;
  accel::BlasBatch blas_batch_;
  accel::SharedBlases shared_blases_;
  accel::OwnBlases own_blases_;
  accel::Detail detail_;
  DrawTable draw_table_;
  std::unique_ptr<accel::CullingStrategy> strategy_;
  std::unique_ptr<accel::Lipac> lipac_;  // null: another strategy
  bool cast_by_map_ = false;
  bool guided_ = false;     // lipac_ decides about this tick: nobody needs everything
  bool frozen_ = false;     // by what it decided before
  bool all_count_ = false;  // every path of this tick counts whom it meets
  bool rests_ = false;      // neither the scene nor a camera moves in this tick
  accel::ViewerQuorum quorum_;
  accel::TlasAssembly tlas_;
  EmitterInstances emitters_;
  LightLists light_lists_;
  PathQueue paths_;
  gpu::Buffer ggx_albedo_;
  effects::Registry registry_;
  effects::EffectSet effects_;
  scene::Environment environment_;
  bool reassemble_ = true;  // the TLAS is not of this tick's instances, poses and viewers
  std::mutex mutex_;
  std::map<ViewHandle, std::unique_ptr<View>> views_;
};

}  // namespace helio::render
