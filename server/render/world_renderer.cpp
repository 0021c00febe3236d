#include "render/world_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "effects/ggx_albedo.h"
#include "render/camera_frame.h"
#include "render/faults.h"

namespace helio::render {
namespace {

constexpr float kNearPlane = 1e-4f;  // metres; reversed float depth loses nothing by it
// Of a pixel's width, that textures are read over where samples lie all over the pixel: together they filter.
constexpr float kSpreadFootprint = 0.25f;
constexpr uint32_t kMostLampsOnce = 1024;  // that a vertex looks at one by one

/// Passes that measure rather than make the picture.
bool isMeasurement(const std::string& pass) { return pass == "log_rays" || pass == "bare_trace"; }

bool shines(const scene::Sky& sky) { return sky.zenith != glm::vec3(0.0f) || sky.ground != glm::vec3(0.0f); }

/// Something that light sampling chooses among.
bool hasLamps(effects::EffectSet effects) {
  return effects.has(effects::Effect::emissive_triangles) || effects.has(effects::Effect::punctual_lights);
}

accel::ClipTable uploadClips(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene) {
  commands.begin();
  accel::ClipTable clips(device, commands, scene);
  commands.submit();
  (void)commands.finish();
  return clips;
}

accel::Viewpoint viewpointOf(const ViewRequest& request) {
  const CameraFrame frame = cameraFrame(request.camera);
  const float aspect = static_cast<float>(request.settings.width) / static_cast<float>(request.settings.height);
  const bool reference = request.settings.mode == Mode::reference;
  const bool levels = request.settings.levels_of_detail && !reference;
  return {accel::frustumOf(request.camera.position, frame.right, frame.up, frame.forward, frame.tangent, aspect),
          reference, levels ? kPixelsOff * 2.0f * frame.tangent / static_cast<float>(request.settings.height) : 0.0f};
}

bool usesRaster(const ViewSettings& settings) {
  return settings.mode == Mode::hybrid && settings.primary == Primary::raster;
}

}  // namespace

struct WorldRenderer::Work {
  View& view;
  int owner;
  std::vector<shared::SampleConstants> samples;
};

WorldRenderer::WorldRenderer(std::shared_ptr<gpu::Device> device, Passes& passes, scene::ScenePtr scene)
    : device_(std::move(device)),
      passes_(passes),
      scene_(std::move(scene)),
      commands_(*device_),
      async_(*device_, gpu::Queue::async),
      resources_(*device_, commands_, *scene_),
      instances_(*device_, *scene_, resources_.emitterPower(), effects::emitterWeight),
      clips_(uploadClips(*device_, commands_, *scene_)),
      units_(*device_, *scene_, clips_, resources_.deforming()),
      blas_batch_(*device_),
      shared_blases_(*device_, resources_.meshRecords(), resources_.shapes()),
      own_blases_(*device_),
      detail_(*scene_),
      draw_table_(*device_, scene_->meshes.size()),
      strategy_(accel::fullStrategy()),
      tlas_(*device_, commands_, *scene_),
      emitters_(*device_, *scene_),
      light_lists_(*device_),
      paths_(*device_),
      registry_(*scene_),
      environment_(scene_->environment) {
  warmUp();
}

// A driver compiles a pipeline when it is first dispatched (lavapipe: up to half a second a variant), so each is
// dispatched once, over an empty world.
void WorldRenderer::warmUp() {
  effects::Registry placed(*scene_);
  for (const scene::Placement& placement : scene_->placements) placed.place(placement.prefab, +1);
  const effects::EffectSet present = placed.present(environment_), possible = placed.possible(environment_);
  View view(device_);
  for (const Primary primary : {Primary::raster, Primary::traced}) {
    ViewSettings settings;
    settings.width = settings.height = 16;
    settings.primary = primary;
    if (cast_by_map_) settings.sun_shadow = SunShadow::rays_and_map;
    for (const effects::EffectSet& effects : {present, possible}) {
      effects_ = effects;
      commands_.begin();
      Graph graph;
      addWorldPasses(graph);
      view.begin(commands_, scene_->cameras.front().camera, settings, true, 0,
                 PathTrace::rayLogStride(settings.bounces));
      Work work{view, 0, {}};
      addViewPasses(graph, work);
      graph.record(commands_);
      commands_.submit();
      (void)commands_.finish();
    }
  }
}

void WorldRenderer::addView(ViewHandle handle) {
  const std::lock_guard lock(mutex_);
  views_.emplace(handle, std::make_unique<View>(device_));
  quorum_.add(handle);
}

void WorldRenderer::removeView(ViewHandle handle) {
  const std::lock_guard lock(mutex_);
  views_.erase(handle);
  quorum_.remove(handle);
  if (lipac_) lipac_->removeViewer(handle);
}

Result<std::vector<Frame>> WorldRenderer::tick(const world::ChangeSet& changes, std::span<const ViewRequest> asked) {
  const std::lock_guard lock(mutex_);
  for (const ViewRequest& request : asked) {
    if (!views_.contains(request.view))
      return Error{ErrorKind::not_found,
                   "no view " + std::to_string(request.view) + " in this world",
                   "view",
                   std::to_string(request.view),
                   {}};
    if (auto valid = check(request.camera); !valid) return valid.error();
    if (auto valid = check(request.settings); !valid) return valid.error();
  }
  const std::vector<ViewRequest> requests = castByMap(asked);

  if (lipac_) lipac_->noteEdits(changes, instances_);
  instances_.apply(changes, [this](uint32_t prefab, int64_t count) { registry_.place(prefab, count); });
  units_.apply(changes, instances_, [this](uint32_t unit) { own_blases_.release(unit); });
  const bool edited = instances_.dirty();
  if (edited) draw_table_.invalidate();
  units_.lookBack(std::any_of(requests.begin(), requests.end(),
                              [](const ViewRequest& request) { return looksBack(request.settings); }));
  const bool moved = units_.pose(changes.time, instances_);
  std::vector<accel::Viewpoint> viewers;
  viewers.reserve(requests.size());
  for (const ViewRequest& request : requests) viewers.push_back(viewpointOf(request));
  strategy_->begin(viewers);
  detail_.begin(viewers);
  detail_.place(instances_, changes);
  detail_.plan(instances_, units_);
  environment_ = changes.environment;
  effects_ = registry_.present(environment_);

  try {
    planStructures(changes, requests, viewers, moved);
    const bool built = !blas_batch_.empty() || shared_blases_.grew();
    // What culls follows the cameras, or the light.
    reassemble_ = reassemble_ || edited || moved || built || instances_.orderDirty() || shared_blases_.dirty() ||
                  strategy_->volumes() != nullptr || lipac_;
    // What guided culling lets in while nothing moves is no change of the scene: averages go on, and nothing that a
    // cache gives back is in the picture.
    return render(changes, requests, edited || moved || (built && !guided_) || changes.environment_changed);
  } catch (const gpu::Failure&) {
    // What was recorded never ran: the next tick brings all of it again.
    instances_.forget();
    ggx_albedo_ = {};
    units_.forget();
    shared_blases_.forget();
    own_blases_.forget();
    draw_table_.invalidate();
    light_lists_.forget();
    if (lipac_) lipac_->forget();
    reassemble_ = true;
    for (const auto& [handle, view] : views_) view->forget();
    throw;
  }
}

std::vector<Frame> WorldRenderer::render(const world::ChangeSet& changes, std::span<const ViewRequest> requests,
                                         bool scene_changed) {
  rests_ = !scene_changed && std::all_of(requests.begin(), requests.end(), [this](const ViewRequest& request) {
    return views_.at(request.view)->isAt(request.camera);
  });
  commands_.begin();
  const bool rasterises = std::any_of(requests.begin(), requests.end(), [this](const ViewRequest& request) {
    return usesRaster(request.settings) || usesShadowMap(request.settings, effects_);
  });
  if (!rasterises) draw_table_.release(commands_);
  Graph graph;
  addWorldPasses(graph);
  const bool learns = std::any_of(requests.begin(), requests.end(),
                                  [this](const ViewRequest& request) { return learnsLamps(request.settings); });
  if (learns) passes_.learn_lamps.addAhead(graph, light_lists_, emitters_);
  std::vector<Work> work;
  work.reserve(requests.size());
  for (const ViewRequest& request : requests) {
    View& view = *views_.at(request.view);
    view.begin(commands_, request.camera, request.settings, scene_changed, changes.tick,
               PathTrace::rayLogStride(request.settings.bounces));
    view.counts_hits = guided_ && !frozen_ && quorum_.counts(request.view, changes.tick);
    work.push_back({view, static_cast<int>(work.size()), {}});
    addViewPasses(graph, work.back());
  }
  if (learns) passes_.learn_lamps.add(graph, light_lists_, emitters_);
  if (guided_) addFeedback(graph, changes.tick);
  // Building beside what is rasterised; nothing else could run in the meantime.
  gpu::Commands* aside = builds_aside_ && rasterises ? &async_ : nullptr;
  if (aside) aside->begin();
  graph.record(commands_, aside);
  commands_.submit();
  const std::vector<gpu::TimedPass> times = graph.finish(commands_, aside);

  std::vector<Frame> frames;
  frames.reserve(work.size());
  for (const Work& w : work) frames.push_back(finishView(graph, times, w, changes));
  return frames;
}

void WorldRenderer::addWorldPasses(Graph& graph) {
  if (!reassemble_ && tlas_.address() != 0) return;
  reassemble_ = false;
  graph.add("instances", Graph::kShared,
            {{&instances_, gpu::use::transfer_write},
             {&units_, gpu::use::transfer_write},
             {&shared_blases_, gpu::use::transfer_write},
             {&own_blases_, gpu::use::transfer_write},
             {&lipac_, gpu::use::transfer_write},
             {&tlas_, gpu::use::transfer_write}},
            [this](gpu::Commands& commands) {
              if (instances_.orderDirty() || !instances_.recordBuffer()) instances_.upload(commands);
              if (units_.dirty()) units_.upload(commands, instances_);
              shared_blases_.upload(commands);
              own_blases_.upload(commands);
              if (guided_) uploadCulling(commands);
              else tlas_.reserve(commands, instances_, *strategy_);
              tlas_.upload(commands);
            });
  if ((instances_.emittersDirty() || emitters_.empty()) && hasLamps(effects_))
    graph.add("emitters", Graph::kShared, {{&emitters_, gpu::use::transfer_write}},
              [this](gpu::Commands& commands) { emitters_.upload(commands, instances_); });
  if (units_.dirty())
    graph.add("pose", Graph::kShared, {{&units_, gpu::use::compute_write}, {&instances_, gpu::use::compute_write}},
              [this](gpu::Commands& commands) { units_.record(commands, instances_); });
  if (own_blases_.hasWork())
    graph.add("deform", Graph::kShared,
              // Who reads the instances reads the poses and vertices that belong to them.
              {{&units_, gpu::use::compute_read},
               {&instances_, gpu::use::compute_write},
               {&own_blases_, gpu::use::compute_write}},
              [this](gpu::Commands& commands) { own_blases_.deform(commands, instances_); });
  if (!blas_batch_.empty() || shared_blases_.hasWork())
    graph.add(
        "blas", Graph::kShared, {{&own_blases_, gpu::use::build_read}, {&blas_batch_, gpu::use::build_write}},
        [this](gpu::Commands& commands) {
          blas_batch_.record(commands);
          shared_blases_.record(commands);
        },
        gpu::Queue::async);
  graph.add(
      "assemble", Graph::kShared,
      {{&instances_, gpu::use::compute_read},
       {&units_, gpu::use::compute_read},
       {&shared_blases_, gpu::use::compute_write},
       {&lipac_, gpu::use::compute_write},
       {&tlas_, gpu::use::compute_write}},
      [this](gpu::Commands& commands) {
        if (guided_) lipac_->assemble(commands, tlas_.surfaces(), tlas_.counted());
        else tlas_.assemble(commands, instances_, shared_blases_);
      },
      gpu::Queue::async);
  graph.add(
      "tlas", Graph::kShared,
      {{&blas_batch_, gpu::use::build_read},
       {&shared_blases_, gpu::use::transfer_read},
       {&tlas_, gpu::use::transfer_read},
       {&tlas_, gpu::use::build_read},
       {&tlas_, gpu::use::build_write}},
      [this](gpu::Commands& commands) {
        tlas_.build(commands);
        if (!guided_) shared_blases_.readBack(commands);
      },
      gpu::Queue::async);
}

void WorldRenderer::addViewPasses(Graph& graph, Work& work) {
  View& view = work.view;
  const ViewSettings& settings = view.settings();
  const ViewPass pass{graph,
                      view,
                      work.owner,
                      &tlas_,
                      &instances_,
                      paths_,
                      guided_ && !frozen_ ? static_cast<Resource>(&lipac_) : nullptr,
                      guided_ && lipac_->settings().box_hits == accel::BoxHits::any_hit,
                      learnsLamps(settings) ? static_cast<Resource>(&light_lists_) : nullptr};
  if (const uint32_t launches = passes_.path_trace.launches(settings); launches > 1)
    paths_.reserve(uint64_t{settings.width} * settings.height, launches);
  if (takesExtraSamples(settings)) paths_.reserveExtra(settings.width, settings.height);

  graph.add("constants", work.owner,
            {{&view.constants, gpu::use::transfer_write}, {&view.state, gpu::use::transfer_write}},
            [this, &view](gpu::Commands& commands) { uploadConstants(commands, view); });

  const DenoiserPasses* denoiser = passes_.denoiser(settings.denoiser);
  const bool shadow_map = usesShadowMap(settings, effects_);
  for (uint32_t i = 0; i < settings.samples; ++i) {
    work.samples.push_back(view.nextSample());
    work.samples.back().tick_sample = i;
    const shared::SampleConstants& sample = work.samples.back();
    if (!usesRaster(settings)) { passes_.primary_traced.add(pass, sample, effects_); }
    // Once a tick; the samples share what is rasterised.
    if (i == 0 && (usesRaster(settings) || shadow_map)) addRasterPasses(pass, sample.jitter);
    if (denoiser) denoiser->addAhead(pass);
    passes_.path_trace.add(pass, sample, effects_);
    if (reconstructs(settings)) {
      passes_.motion.add(pass, sample);
      passes_.reconstruct.add(pass, sample);
    }
    passes_.statistics.add(pass, sample);
    if (view.averaging()) passes_.accumulate.add(pass, sample);
  }

  const shared::SampleConstants last = view.finalConstants();
  if (replacesPicture(settings) && !reconstructs(settings)) passes_.motion.add(pass, work.samples.back());
  if (denoiser) denoiser->addBetween(pass, work.samples.back());
  if (takesExtraSamples(settings)) {
    passes_.extra_samples.add(pass, work.samples.back());
    passes_.path_trace.addExtra(pass, work.samples.back(), effects_, passes_.statistics);
  }
  if (sunGoesApart(settings, effects_)) passes_.sunlight.add(pass, last);
  if (occlusionGoesApart(settings)) passes_.occlusion.add(pass, last);
  if (denoiser) denoiser->add(pass, work.samples.back(), last);
  if (knowsVariance(settings)) passes_.error_estimate.add(pass, last);
  if (settings.taa && settings.inspect == Inspect::nothing) passes_.taa.add(pass);
  if (settings.inspect != Inspect::nothing) passes_.inspect.add(pass, work.samples.back());
  if (settings.culling_view != CullingView::none) passes_.culling_view.add(pass, work.samples.back());
  if (settings.auto_exposure) passes_.exposure.add(pass, last);
  passes_.tonemap.add(pass, last);
  graph.add("read_back", work.owner,
            {{&view.pixels, gpu::use::transfer_read},
             {&view.draws, gpu::use::transfer_read},
             {&view.shadow_draws, gpu::use::transfer_read},
             {&view.state, gpu::use::transfer_read},
             {&view.shown(), gpu::use::transfer_read}},
            [&view, shadow_map](gpu::Commands& commands) {
              if (usesRaster(view.settings())) view.draws.readBack(commands);
              if (shadow_map) view.shadow_draws.readBack(commands);
              commands.copy(view.pixels, view.pixels_readback->buffer, view.pixels.size());
              commands.copy(view.state, view.state_readback, sizeof(shared::ViewState));
              if (view.settings().keep_radiance) commands.copy(view.shown(), view.radiance_readback);
              commands.barrier(gpu::use::transfer_write, gpu::use::host_read);
            });
  if (settings.measure_bare_trace) {
    passes_.path_trace.addLog(pass, work.samples.back(), effects_);
    passes_.bare_trace.add(pass, work.samples.back(), effects_);
  }
}

void WorldRenderer::addRasterPasses(const ViewPass& pass, const glm::vec2& jitter) {
  const ViewSettings& settings = pass.view.settings();
  if (draw_table_.dirty())
    pass.graph.add("draw_table", Graph::kShared, {{&draw_table_, gpu::use::transfer_write}},
                   [this](gpu::Commands& commands) {
                     if (draw_table_.dirty()) draw_table_.upload(commands, instances_);  // for all views
                   });
  const RasterPass raster{resources_, draw_table_, instances_, passes_.culling, effects_};
  if (usesRaster(settings)) passes_.primary_raster.add(pass, raster, jitter);
  if (!usesShadowMap(settings, effects_)) return;
  accel::OrderBlock world;
  scene::Aabb bounds;
  for (const accel::OrderBlock& block : instances_.blocks())
    bounds.grow({block.centre - block.radius, block.centre + block.radius});
  if (!bounds.empty()) world = {bounds.centre(), 0.5f * glm::length(bounds.extent())};
  // In the place of rays the map has everything; together with them it has what they do not meet.
  ShadowCasters casters;
  if (settings.sun_shadow == SunShadow::rays_and_map)
    casters = guided_ ? ShadowCasters{&lipac_->untraced(), &lipac_} : ShadowCasters{&tlas_.untraced(), pass.tlas};
  passes_.shadow_map.add(pass, raster, -glm::normalize(environment_.sun.direction), world, casters);
}

void WorldRenderer::uploadConstants(gpu::Commands& commands, View& view) {
  const ViewSettings& settings = view.settings();
  const CameraFrame camera = cameraFrame(view.camera());
  shared::FrameConstants c{};
  c.position = view.camera().position;
  c.right = camera.right;
  c.up = camera.up;
  c.forward = camera.forward;
  c.tangent = camera.tangent;
  c.aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  c.near_plane = kNearPlane;
  // A texture read over a footprint is not the mean of what it reads finely once a mask, a normal or a second bounce
  // depends on it: the reference averages samples instead.
  if (settings.mode != Mode::reference) {
    c.pixel_spread = std::atan(2.0f * camera.tangent / static_cast<float>(settings.height));
    if (view.spreadsSamples()) c.pixel_spread *= kSpreadFootprint;
    c.cone_growth = 1.0f;
  }
  c.width = settings.width;
  c.height = settings.height;

  c.tlas = tlas_.address();
  c.instances = instances_.recordBuffer().address();
  c.meshes = resources_.meshes();
  c.traced_meshes = shared_blases_.table();
  c.geometries = resources_.geometries();
  c.materials = resources_.materials();
  c.emitter_triangles = resources_.emitterTriangles();
  if (hasLamps(effects_)) emitters_.describe(c);

  // A disc of half angle a and radiance L gives the irradiance L pi sin^2 a. 1 - cos a = 2 sin^2(a / 2) keeps its
  // digits.
  const scene::Sun& sun = environment_.sun;
  const double half_angle = 0.5 * static_cast<double>(sun.angular_diameter);
  c.sun_to = -glm::normalize(sun.direction);
  c.sun_radiance = sun.irradiance / static_cast<float>(3.14159265358979 * std::pow(std::sin(half_angle), 2.0));
  c.sun_one_minus_cos = static_cast<float>(2.0 * std::pow(std::sin(0.5 * half_angle), 2.0));
  c.sky_zenith = environment_.sky.zenith;
  c.sky_ground = environment_.sky.ground;

  if (usesShadowMap(settings, effects_)) c.shadow_map = view.shadow_constants.address();

  c.max_scatterings = PathTrace::vertices(settings.bounces) - 1;
  if (showsProperty(settings.materials)) {  // of the first hit alone, before black
    c.max_scatterings = 0;
    c.sky_zenith = c.sky_ground = glm::vec3(0.0f);
  }
  c.roulette = settings.roulette;
  describeTechnique(c, view);
  c.independent_samples = settings.sampler == Sampler::independent;
  c.light_sampling = settings.light_sampling;
  c.mis = settings.mis;
  c.sky_sampling = settings.light_sampling && settings.sky_sampling && shines(environment_.sky);
  c.lamp_samples = settings.lamp_samples > 0 || c.emitter_instance_count <= kMostLampsOnce || learnsLamps(settings)
                       ? settings.lamp_samples
                       : 64;
  if (!settings.light_lists) c.light_grid_size = {};
  c.round_surfaces = settings.round_surfaces;
  if (settings.mode == Mode::hybrid) c.least_alpha = settings.regularisation * settings.regularisation;
  if (settings.multiple_scattering) c.ggx_albedo = ggxAlbedo(commands);
  // A reference image must not depend on the frames before it.
  const bool reference = settings.mode == Mode::reference;
  c.roulette_exposure = reference || !(view.lastExposure() > 0.0f) ? 1.0f : view.lastExposure();

  c.visibility = view.visibility.slot();
  c.radiance = view.radiance.slot();
  c.accumulation = view.accumulation.slot();
  c.path_info = view.path_info.slot();
  paths_.describe(c);
  c.extra_paths = settings.extra_samples;
  if (guided_) describeCounting(c, view);
  c.view_state = view.state.address();
  c.pixels = view.pixels.address();
  c.ray_log = view.ray_log ? view.ray_log.address() : 0;
  c.ray_log_stride = PathTrace::rayLogStride(settings.bounces);
  if (looksBack(settings)) {
    shared::HistoryConstants history = view.histories.constants();
    units_.describe(history);
    if (!sunGoesApart(settings, effects_)) history.sunlight = 0;
    history.reshades = history.known > 0 && !view.accumulating() ? 1 : 0;
    commands.upload<shared::HistoryConstants>(view.histories.buffer, 0, std::span(&history, 1));
    c.history = view.histories.buffer.address();
  }
  commands.upload<shared::FrameConstants>(view.constants, 0, std::span(&c, 1));

  constexpr uint64_t kCounters = offsetof(shared::ViewState, bounce_rays);
  const std::vector<std::byte> zeros(sizeof(shared::ViewState) - kCounters);
  commands.upload(view.state, kCounters, zeros);
}

VkDeviceAddress WorldRenderer::ggxAlbedo(gpu::Commands& commands) {
  if (!ggx_albedo_) {
    const shared::GgxAlbedo table = effects::ggxAlbedo();
    ggx_albedo_ = gpu::Buffer(*device_, {"the GGX albedo", sizeof table, gpu::MemoryCategory::path_tracing});
    commands.upload<shared::GgxAlbedo>(ggx_albedo_, 0, std::span(&table, 1));
  }
  return ggx_albedo_.address();
}

Frame WorldRenderer::finishView(const Graph& graph, const std::vector<gpu::TimedPass>& times, const Work& work,
                                const world::ChangeSet& changes) {
  View& view = work.view;
  const ViewSettings& settings = view.settings();
  view.state_readback.invalidate();
  shared::ViewState state;
  std::memcpy(&state, view.state_readback.mapped(), sizeof state);

  Frame frame;
  FrameStats& stats = frame.stats;
  stats.tick = changes.tick;
  stats.span_ms = commands_.spanMs();
  stats.applied_seq = changes.applied_seq;
  stats.time = changes.time;
  for (size_t i = 0; i < times.size(); ++i) {
    if (const int owner = graph.passes()[i].owner; owner != Graph::kShared && owner != work.owner) continue;
    if (times[i].name == "bare_trace") stats.bare_trace_ms = times[i].ms;
    if (isMeasurement(times[i].name)) continue;
    stats.gpu_ms += times[i].ms;
    // Several samples a tick repeat passes: one row each.
    const auto row = std::find_if(stats.passes.begin(), stats.passes.end(),
                                  [&](const PassTime& p) { return p.name == times[i].name; });
    if (row != stats.passes.end()) row->ms += times[i].ms;
    else stats.passes.push_back({times[i].name, times[i].ms});
  }
  const uint64_t texels = uint64_t{settings.width} * settings.height;
  stats.rays.primary = usesRaster(settings) ? 0 : texels * settings.samples;
  stats.rays.bounce = state.bounce_rays;
  stats.rays.shadow = state.shadow_rays;
  stats.rays.retrace = state.retrace_rays;
  stats.extra_paths = state.extra_paths;
  reportFaults(state.faults, settings.width, stats);
  stats.accumulated = view.accumulated();
  stats.tlas_instances = tlas_.entered();
  if (guided_) {
    stats.lipac = lipac_->figures();
    stats.tlas_instances = stats.lipac->entries;
  }
  stats.acceleration = accelerationUse(view);
  if (usesRaster(settings)) stats.triangles_drawn = view.draws.triangles();
  if (usesShadowMap(settings, effects_)) stats.shadow_triangles = view.shadow_draws.triangles();
  stats.exposure = settings.auto_exposure ? state.exposure : std::exp2(settings.exposure_ev);
  stats.memory = {device_->memoryInUse(gpu::MemoryCategory::raster),
                  device_->memoryInUse(gpu::MemoryCategory::ray_tracing),
                  device_->memoryInUse(gpu::MemoryCategory::path_tracing),
                  device_->memoryInUse(gpu::MemoryCategory::transfer),
                  tlas_.scratchBytes() + blas_batch_.scratchBytes() + paths_.bytes() + view.draws.bytes() +
                      view.shadow_draws.bytes(),
                  instances_.cpuBytes() + units_.cpuBytes() + own_blases_.cpuBytes() + blas_batch_.cpuBytes() +
                      detail_.cpuBytes() + draw_table_.cpuBytes()};
  if (knowsVariance(settings)) stats.variance = ErrorEstimate::variance(state, texels);
  stats.history_bytes = view.histories.bytes();
  stats.effects = effectCosts(stats.passes);
  view.setLastExposure(static_cast<float>(stats.exposure));

  view.pixels_readback->buffer.invalidate();
  // Aliases the lease: the buffer returns to its pool with the last holder of the picture.
  struct Picture {
    std::shared_ptr<PixelPool::Lease> lease;
    Pixels pixels;
  };
  auto picture = std::make_shared<Picture>(Picture{std::move(view.pixels_readback), {}});
  picture->pixels = {reinterpret_cast<const uint8_t*>(picture->lease->buffer.mapped()), settings.width,
                     settings.height};
  frame.pixels = std::shared_ptr<const Pixels>(picture, &picture->pixels);

  if (settings.keep_radiance) {
    view.radiance_readback.invalidate();
    const auto* texel = reinterpret_cast<const float*>(view.radiance_readback.mapped());
    frame.radiance.resize(texels * 3);
    for (uint64_t i = 0; i < texels; ++i)
      for (uint64_t c = 0; c < 3; ++c) frame.radiance[3 * i + c] = texel[4 * i + c];
  }
  return frame;
}

std::vector<EffectCost> WorldRenderer::effectCosts(const std::vector<PassTime>& passes) const {
  using effects::Effect;
  const auto pass_ms = [&](const std::string& name) {
    for (const PassTime& pass : passes)
      if (pass.name == name) return pass.ms;
    return 0.0;
  };
  std::vector<EffectCost> costs;
  for (size_t i = 0; i < effects::kEffects; ++i) {
    const auto effect = static_cast<Effect>(i);
    if (!effects_.has(effect)) continue;
    EffectCost cost{effects::name(effect), registry_.instances(effect), 0, 0.0};
    if (effect == Effect::textures) cost.memory_bytes = resources_.textureBytes();
    if (effect == Effect::emissive_triangles) {
      cost.memory_bytes = resources_.emitterBytes() + emitters_.bytes();
      cost.pass_ms = pass_ms("emitters");
    }
    costs.push_back(std::move(cost));
  }
  return costs;
}

}  // namespace helio::render
