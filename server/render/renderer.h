// What renders worlds: the only face of `render/` that services, benchmarks and tools see.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "accel/lipac_settings.h"
#include "accel/shared_blas_settings.h"
#include "base/result.h"
#include "render/material_override.h"
#include "scene/scene.h"
#include "shared/culling_view.h"
#include "shared/history.h"
#include "shared/technique.h"
#include "world/world.h"

namespace helio::render {

enum class Mode {
  hybrid,     ///< primary hits by `primary`, one sample a pixel a tick
  reference,  ///< traced primary rays with pixel jitter, everything in the TLAS, accumulated, no approximation
};
enum class Primary { raster, traced };

/// Who rasterises primary hits and shadow maps.
enum class Rasteriser {
  automatic,  ///< compute shaders, but for shadow maps on CPUs: what was measured to be fast
  graphics,   ///< the graphics pipeline
  compute     ///< compute shaders
};
enum class Sampler {
  low_discrepancy,  ///< Owen-scrambled Sobol points, blue noise over pixels
  independent,      ///< hashes: the baseline
};

enum class SunShadow {
  rays,          ///< soft, by rays
  rays_and_map,  ///< as well as by a shadow map of what rays cannot meet (a hard shadow: biased)
  map,           ///< by a shadow map of everything, without a ray (biased)
};

/// What turns one sample a pixel into a picture that is good to look at. Biased; not in reference mode.
enum class Denoiser {
  none,
  svgf,    ///< spatiotemporal variance-guided filtering [Schied et al. 2017]
  asvgf,   ///< the same, with a history as long as the light stays what it was [Schied et al. 2018]
  reblur,  ///< recurrent blur: the history is blurred again in every tick [Zhdan 2021]
};
/// How light is followed: the stages of ray tracing's history [Lipp 2021, table 4.1]. Reference mode knows path tracing
/// alone; the others are biased.
enum class Technique : uint32_t {
  path_traced = shared::kTechniquePathTraced,
  /// Direct light with soft shadows, and what lobes that shine show: none that was scattered diffusely before.
  distributed = shared::kTechniqueDistributed,
  /// Hard shadows of points in the lamps' centres, sharp reflections, nothing at random.
  whitted = shared::kTechniqueWhitted,
};
/// What stands in the place of light scattered diffusely, where a technique has none (biased).
enum class Ambient : uint32_t {
  none = shared::kAmbientNone,
  constant = shared::kAmbientConstant,  ///< the sky's, as if nothing stood in its way
  occluded = shared::kAmbientOccluded,  ///< ambient occlusion: the sky's, where a ray meets nothing within a radius
};
/// In how many pixels paths go on beyond the surface that they show; the others look at their neighbours'.
enum class IndirectRate : uint32_t {
  full = shared::kIndirectFull,
  half = shared::kIndirectHalf,
  quarter = shared::kIndirectQuarter,
};
/// How the others do that (biased).
enum class Reconstruction {
  reuse,      ///< neighbours' rays, weighted by the pixel's own BRDF over their density [Stachowiak 2015]
  bilateral,  ///< neighbours' results, weighted by how alike their surfaces are [Kopf et al. 2007]
};
/// Plain numbers in the picture's place (shaders/shared/history.h says which): for tests and for the curious.
enum class Inspect : uint32_t {
  nothing = shared::kInspectNothing,
  motion = shared::kInspectMotion,
  position = shared::kInspectPosition,
  before = shared::kInspectBefore,
  unfiltered = shared::kInspectUnfiltered,
  // What a denoiser has.
  diffuse = shared::kInspectDiffuse,
  specular = shared::kInspectSpecular,
  samples = shared::kInspectSamples,
};

/// Light path guided culling in the picture's place (shaders/shared/culling_view.h says what the colours are).
enum class CullingView : uint32_t {
  none = shared::kCullingViewNone,
  states = shared::kCullingViewStates,      ///< of instances
  hitboxes = shared::kCullingViewHitboxes,  ///< states of hitboxes, brighter by hits
  untraced = shared::kCullingViewUntraced,  ///< what is drawn, and rays do not meet
  rays = shared::kCullingViewRays,          ///< by kind
  above = shared::kCullingViewAbove,        ///< the world from above, hitboxes by hits
};

/// A viewer's settings. A change of size, mode, primary, bounces or materials restarts
/// accumulation.
struct ViewSettings {
  uint32_t width = 640;   ///< pixels, [16, 8192]
  uint32_t height = 360;  ///< pixels, [16, 8192]
  Mode mode = Mode::hybrid;
  Primary primary = Primary::raster;
  uint32_t bounces = 3;  ///< B, [0, 32]: all paths of 0 to B + 1 scatterings
  uint32_t samples = 1;  ///< paths a pixel a tick, [1, 64]
  bool roulette = true;  ///< Russian roulette (unbiased)
  Sampler sampler = Sampler::low_discrepancy;
  bool light_sampling = true;   ///< next event estimation (unbiased); punctual lights are sampled without it too
  bool mis = true;              ///< multiple importance sampling of lights and BSDF (unbiased); off: lights alone
  bool sky_sampling = false;    ///< light sampling looks for the sky too (unbiased)
  uint32_t lamp_samples = 1;    ///< of a path's first vertex, [0, 64] (unbiased); 0: each lamp once, if there are at
                                ///< most 1,024, else 64
  bool light_lists = true;      ///< lamps are chosen from their cell's list (unbiased); off: among all by power
  bool light_feedback = false;  ///< lists learn from shadow rays which lamps their cells see (unbiased); with
                                ///< lamp_samples 0: each that is seen once, and one of the others. Needs light_lists;
                                ///< not in reference mode, whose pictures do not depend on the ticks before
  bool round_surfaces = true;   ///< rays leave from the surface that vertex normals tell of, against faceted shadows
  bool multiple_scattering = false;  ///< GGX lobes keep the light that they scatter more than once
  float regularisation = 0.0f;       ///< least perceptual roughness after a rough scattering, [0, 1]; biased, so not
                                     ///< in reference mode
  Technique technique = Technique::path_traced;
  Ambient ambient = Ambient::none;
  float ambient_radius = 10.0f;                     ///< metres within which occluders count, (0, 1e6]
  IndirectRate indirect_rate = IndirectRate::full;  ///< not in reference mode
  Reconstruction reconstruction = Reconstruction::reuse;
  float aperture = 0.0f;  ///< metres of the lens' diameter, [0, 10]: depth of field; primary hits must be traced
  float focus = 10.0f;    ///< metres from the camera to the plane that is sharp, [0.01, 1e6]
  SunShadow sun_shadow = SunShadow::rays;  ///< reference mode knows rays alone
  uint32_t shadow_map_size = 2048;         ///< texels along a side of each of its cascades, [256, 4096]
  Rasteriser rasteriser = Rasteriser::automatic;
  bool levels_of_detail = true;  ///< meshes that differ from the finest by half a pixel (biased, so not in reference
                                 ///< mode); off for one view: rays meet the finest in all of the world's
  MaterialOverride materials = MaterialOverride::none;  ///< in the place of all materials, to look at one thing
  CullingView culling_view = CullingView::none;         ///< not in reference mode
  Denoiser denoiser = Denoiser::none;
  float extra_samples = 0.0f;  ///< paths a pixel more that a tick may take where what is known of the light is young
                               ///< and noisy, as a mean over the picture, [0, 4]; needs a denoiser, one sample a tick
                               ///< and indirect_rate full; not in reference mode
  bool taa = false;  ///< temporal anti-aliasing: ticks look at different points of the pixels; not in reference mode
  Inspect inspect = Inspect::nothing;  ///< not in reference mode
  bool poison_history = false;         ///< a test's hook: makes NaN of what a denoiser kept, ahead of this tick
  bool accumulate = true;              ///< average over ticks while camera and world stand still
  bool auto_exposure = true;
  float exposure_ev = 0.0f;    ///< fixed: radiance is scaled by 2^ev; automatic: compensation, [-16, 16]
  bool keep_radiance = false;  ///< also hand out linear radiance (shot, fidelity, tests)
  uint32_t path_launches = 0;  ///< launches of a sample's paths, at most; 0: what is fastest. The picture is the same
  bool measure_bare_trace = false;  ///< also trace the same rays with empty shading (benchmarks; costs memory and time)
};

struct DeviceInfo {
  std::string name;
  std::string driver;
  bool cpu = false;  ///< a software device such as lavapipe
};

struct PassTime {
  std::string name;
  double ms = 0.0;
};
struct EffectCost {
  std::string name;
  uint64_t instances = 0;     ///< live instances that call for it
  uint64_t memory_bytes = 0;  ///< GPU memory that exists only for it
  double pass_ms = 0.0;       ///< time of the passes that only it calls for
};
struct Rays {
  uint64_t primary = 0, bounce = 0, shadow = 0, retrace = 0;
  uint64_t total() const { return primary + bounce + shadow + retrace; }
};

/// Memory by the thesis's categories (§4.3), bytes: the GPU's of the whole device, all its worlds together.
struct MemoryUse {
  uint64_t raster = 0;        ///< needed by rasterisation too: meshes, textures, materials, common targets
  uint64_t ray_tracing = 0;   ///< inherent to ray tracing: acceleration structures, scratch, instance buffers
  uint64_t path_tracing = 0;  ///< path tracing only: accumulation, denoiser
  uint64_t staging = 0;       ///< uploads and pictures on their way to the CPU; in no category of the thesis
  // Of this world.
  uint64_t working_set = 0;  ///< of the above, holds nothing from tick to tick: scratch, lists of paths and draws
  uint64_t cpu = 0;          ///< tables of instances, units, levels of detail and BLASes on the CPU's side
};

/// Samples that were no light (not finite, or negative), by the pass that found them: "primary", "path_trace",
/// "accumulate"; and by cause: "NaN", "infinite", "negative".
struct DroppedSamples {
  std::string pass;
  std::string cause;
  uint64_t samples = 0;
};
/// Where the first of a frame's dropped samples was: enough to look at it again.
struct FaultPlace {
  std::string pass;
  std::string cause;
  uint32_t x = 0, y = 0;  ///< pixel
  uint32_t sample = 0;    ///< among those that are averaged
  uint32_t vertex = 0;    ///< of the path, the camera's aside
  uint32_t seed = 0;      ///< of the samples that are averaged; of a further path (extra_samples), its tick's
};

/// What a world's acceleration structures hold and cost, of this tick.
struct AccelerationUse {
  uint32_t own_blases = 0;          ///< BLASes that belong to one instance, in this tick's TLAS
  uint32_t own_blases_in_view = 0;  ///< those of them in the view's frustum
  uint32_t own_blases_waiting = 0;  ///< wanted, and left to a later tick by the budget
  // BLASes of a mesh at one level of detail, which instances share: there, needed but kept out by a budget, and in this
  // tick built and given back.
  uint32_t shared_blases = 0, shared_blases_waiting = 0, shared_blases_built = 0, shared_blases_evicted = 0;
  uint32_t blases_built = 0;
  uint32_t blases_refitted = 0;
  uint64_t blas_triangles = 0;   ///< built or refitted in this tick
  uint32_t levels_switched = 0;  ///< instances without a BLAS of their own that changed their level of detail
  // Bytes of this world.
  uint64_t shared_blas_bytes = 0;       ///< one a mesh and level of detail
  uint64_t compaction_saved_bytes = 0;  ///< that they would need more, had they not been compacted
  uint64_t own_blas_bytes = 0;          ///< allocated for BLASes of instances' own
  uint64_t own_vertex_bytes = 0;        ///< allocated for their deformed vertices
  uint64_t tlas_bytes = 0;              ///< with the instances that it is built from
  uint64_t scratch_bytes = 0;           ///< working set of the builds
  uint64_t culling_bytes = 0;           ///< counters and states of light path guided culling
  uint64_t total() const {
    return shared_blas_bytes + own_blas_bytes + own_vertex_bytes + tlas_bytes + scratch_bytes + culling_bytes;
  }
};

struct FrameStats {
  uint64_t tick = 0;
  uint64_t applied_seq = 0;
  double time = 0.0;                ///< world time, seconds
  double gpu_ms = 0.0;              ///< sum of the passes
  double span_ms = 0.0;             ///< from the first pass of the tick to the end of the last: less than the sum where
                                    ///< passes run beside each other, and more where several viewers share the tick
  double bare_trace_ms = 0.0;       ///< with measure_bare_trace
  std::vector<PassTime> passes;     ///< in order; the world's own (assemble, tlas, ...) first
  std::vector<EffectCost> effects;  ///< present ones only
  Rays rays;
  uint64_t extra_paths = 0;               ///< taken by extra_samples; their rays are in `rays`
  uint64_t nonfinite = 0;                 ///< samples dropped because they were not finite, or negative
  std::vector<DroppedSamples> dropped;    ///< the same by pass and cause, kinds that there were
  std::optional<FaultPlace> first_fault;  ///< set when nonfinite > 0
  uint32_t accumulated = 1;               ///< samples a pixel behind this picture
  uint32_t tlas_instances = 0;
  uint64_t triangles_drawn = 0;    ///< rasterised for primary hits
  uint64_t shadow_triangles = 0;   ///< rasterised for the sun's shadow map, all cascades together
  double exposure = 1.0;           ///< factor on radiance
  std::optional<double> variance;  ///< mean over pixels and channels of variance / (radiance^2 + 0.01), as far as the
                                   ///< denoiser knows; set where it does
  uint64_t history_bytes = 0;      ///< GPU memory of what this view keeps of the ticks before, and of its denoiser
  MemoryUse memory;
  AccelerationUse acceleration;
  std::optional<accel::LipacFigures> lipac;  ///< when light path guided culling decided about this tick
};

/// 8-bit sRGB pixels, 4 bytes each (the 4th is 255), rows top-down, no padding.
struct Pixels {
  const uint8_t* rgbx = nullptr;
  uint32_t width = 0;
  uint32_t height = 0;
};

struct Frame {
  std::shared_ptr<const Pixels> pixels;  ///< returns to its pool when the last holder lets go; may outlive the view
  std::vector<float> radiance;           ///< with keep_radiance: width * height * 3, rows top-down, W/(sr m^2)
  FrameStats stats;
};

using WorldHandle = uint64_t;
using ViewHandle = uint64_t;

struct ViewRequest {
  ViewHandle view = 0;
  scene::Camera camera;
  ViewSettings settings;
};

/// Which instances rays can meet.
enum class Culling {
  full,            ///< all
  frustum_radius,  ///< those in a viewer's frustum or within 800 m of a viewer [Kelling §4.2]; reference views: all
  lipac,           ///< those that light paths meet [Kelling et al. 2024]; reference views: all
  none,            ///< those alone that are too large to be culled: the control that pictures must fail
  distance,        ///< those within a radius of a viewer: what lipac is compared with
};

struct CullingSettings {
  accel::LipacSettings lipac;  ///< of lipac
  float radius = 800.0f;       ///< metres, > 0; of frustum_radius and distance
  /// What lipac culls casts the sun's shadow by the map: views with SunShadow::rays get rays_and_map.
  bool cast_by_map = false;
  // What a tick may build of BLASes; refits have no budget.
  uint32_t builds = 1024;
  uint64_t build_triangles = 1'000'000;
  accel::SharedBlasSettings shared_blases;  ///< of all but full
};

/// What light path guided culling made of an instance in the last tick.
struct CulledInstance {
  uint32_t state = 0;   ///< kState... (shaders/shared/lipac.h)
  bool traced = false;  ///< it was in that tick's TLAS
  bool always = false;  ///< it is too large to be culled
  double hits = 0.0;    ///< smoothed, a tick of 1920 x 1080 paths
};

/// Thread-safe: different worlds may be ticked from different threads (they share the device's queue); one world from
/// one thread at a time.
class Renderer {
 public:
  virtual ~Renderer() = default;
  virtual DeviceInfo device() const = 0;

  /// Uploads a scene. Errors: out of memory (limit).
  virtual Result<WorldHandle> addWorld(scene::ScenePtr scene) = 0;
  virtual void removeWorld(WorldHandle world) = 0;
  virtual Result<ViewHandle> addView(WorldHandle world) = 0;
  virtual void removeView(ViewHandle view) = 0;

  /// From the next tick on. Errors: no such world (not_found), a setting out of range (invalid), a renderer that knows
  /// no culling (unsupported).
  virtual Result<void> setCulling(WorldHandle world, Culling culling, const CullingSettings& settings);
  Result<void> setCulling(WorldHandle world, Culling culling) { return setCulling(world, culling, CullingSettings{}); }

  /// Light path guided culling: states stay as they are, and nobody counts, so that one can look at them from
  /// elsewhere, or measure what counting costs. setCulling() thaws. Errors: no such world (not_found), a renderer that
  /// knows no culling (unsupported).
  virtual Result<void> freezeCulling(WorldHandle world, bool frozen);

  /// By slot; of slots without an instance nothing is said. Reads back whole tables: for tests and benchmarks. Errors:
  /// no such world (not_found), another strategy than light path guided culling (unsupported).
  virtual Result<std::vector<CulledInstance>> culledInstances(WorldHandle world);

  /// One tick: applies the changes, brings the acceleration structures up to date, renders every view, waits for the
  /// GPU. Frames come in the order of `views`. Errors: invalid settings or camera (invalid), out of memory (limit).
  virtual Result<std::vector<Frame>> tick(WorldHandle world, const world::ChangeSet& changes,
                                          std::span<const ViewRequest> views) = 0;
};

/// Checks a camera and settings before anything is queued: finite, not degenerate, in range. Names the field and the
/// limit.
Result<void> check(const scene::Camera& camera);
Result<void> check(const ViewSettings& settings);
Result<void> check(const CullingSettings& settings);

struct RendererOptions {
  std::string
      device;  ///< part of a device's name, "cpu", "gpu", or "" (the environment's HELIOGRAPH_DEVICE, then the best)
  bool validation = false;         ///< Khronos validation layer: errors are logged and counted
  bool strict_validation = false;  ///< tests: a validation error makes the next tick fail
  /// Acceleration structures are built beside what is rasterised, on the device's compute queue (without one, both take
  /// turns on one queue). On the H200 queues that wait for each other cost more than hides (tests/bench/README.md).
  bool builds_aside = false;
  bool one_call_a_blas = false;     ///< BLASes of instances' own are built one by one: to measure what the batch saves
  Culling culling = Culling::full;  ///< with which worlds begin
  CullingSettings culling_settings;
  bool strict_numerics = false;  ///< a sample that is dropped makes its tick fail (internal), and the error says where
};

/// Errors: no Vulkan, no such device, no ray tracing pipelines: each says what to do.
Result<std::unique_ptr<Renderer>> makeRenderer(const RendererOptions& options);

}  // namespace helio::render
