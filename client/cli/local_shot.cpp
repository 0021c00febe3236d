// helio shot --local: the renderer without a server.
#include <algorithm>
#include <cmath>
#include <utility>

#include "cli/progress.h"
#include "cli/shot.h"
#include "render/choices.h"
#include "render/light_switches.h"
#include "render/renderer.h"
#include "scene/city.h"
#include "scene/gltf.h"
#include "scene/spec.h"
#include "stream/jpeg.h"
#include "stream/picture.h"

namespace helio::cli {
namespace {

constexpr uint32_t kSamplesPerTick = 4;  // so that the bar moves

/// What a SPEC asks for, in the options' place. Its scene has one camera and one light.
scene::ScenePtr follow(const std::string& file, ShotOptions& options) {
  const scene::Spec spec = get(scene::loadSpec(file));
  options.size = std::to_string(spec.width) + "x" + std::to_string(spec.height);
  options.bounces = spec.bounces;
  options.materials = spec.lambert ? "lambert" : "none";
  if (!options.samples) options.samples = spec.samples;
  return spec.scene;
}

scene::ScenePtr load(const ShotOptions& options) {
  if ((options.city != 0) == !options.gltf.empty()) throw Stop{"--local needs either --city INSTANCES or --gltf FILE"};
  if (options.city != 0) return get(scene::generateCity({options.seed, options.city, options.animated}));
  return get(scene::loadGltf(options.gltf));
}

const scene::NamedCamera& named(const scene::Scene& scene, const std::string& name) {
  if (name.empty()) return scene.cameras.front();
  const auto found =
      std::find_if(scene.cameras.begin(), scene.cameras.end(), [&](const auto& c) { return c.name == name; });
  if (found != scene.cameras.end()) return *found;
  std::string names;
  for (const auto& camera : scene.cameras) names += " " + camera.name;
  throw Stop{"there is no camera \"" + name + "\"; there are:" + names};
}

struct Look {
  scene::Camera camera;
  scene::Environment light;
};

Look look(const scene::Scene& scene, const ShotOptions& options) {
  const auto& camera = named(scene, options.camera);
  Look out{camera.camera, camera.environment};
  if (!options.position.empty()) {
    const auto vec = [](const std::vector<float>& v) { return glm::vec3(v[0], v[1], v[2]); };
    out.light = scene.environment;
    out.camera.position = vec(options.position);
    out.camera.forward = glm::normalize(vec(options.target) - vec(options.position));
    out.camera.up = std::abs(out.camera.forward.y) > 0.9999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
    out.camera.vfov = static_cast<float>(radians(options.vfov));
  }
  if (options.sun_elevation)
    out.light = scene::daylight(static_cast<float>(radians(*options.sun_elevation)),
                                static_cast<float>(radians(options.sun_azimuth)));
  return out;
}

std::string encode(const render::Frame& frame, const ShotOptions& options) {
  switch (codecOf(options.out)) {
    case v1::CODEC_PFM:
      return stream::encodePfm(frame.radiance, frame.pixels->width, frame.pixels->height);
    case v1::CODEC_PNG:
      return get(stream::encodePng(*frame.pixels));
    default:
      break;
  }
  std::string jpeg;
  stream::JpegEncoder encoder;
  get(encoder.encode(*frame.pixels, options.quality, jpeg));
  return jpeg;
}

}  // namespace

ShotResult shootLocally(ShotOptions options) {
  // Check what was asked for before a model is loaded; a SPEC names its own.
  scene::ScenePtr scene = options.spec.empty() ? nullptr : follow(options.spec, options);
  const uint32_t samples = options.samples.value_or(kShotSamples);
  const Size size = parseSize(options.size);
  render::ViewSettings settings;
  settings.width = size.width;
  settings.height = size.height;
  settings.mode = *render::byName(render::kModes, options.mode);
  settings.primary = *render::byName(render::kPrimaries, options.primary);
  settings.bounces = options.bounces;
  settings.materials = *render::materialOverride(options.materials);
  for (const render::LightSwitch& each : render::kLightSwitches) {
    const auto* field = v1::LightTransport::descriptor()->FindFieldByName(each.name);
    if (options.light.GetReflection()->HasField(options.light, field))
      settings.*each.field = options.light.GetReflection()->GetBool(options.light, field);
  }
  options.approximations.put(settings);
  settings.regularisation = options.light.regularisation();
  if (options.light.has_lamp_samples()) settings.lamp_samples = options.light.lamp_samples();
  settings.samples = std::min(samples, kSamplesPerTick);
  settings.auto_exposure = !options.fixed_exposure;
  settings.exposure_ev = options.exposure_ev;
  settings.keep_radiance = codecOf(options.out) == v1::CODEC_PFM;
  get(render::check(settings));

  const auto renderer = get(render::makeRenderer({options.device, options.validation, false}));
  if (!scene) scene = load(options);
  const Look view = look(*scene, options);
  get(render::check(view.camera));
  const auto handle = get(renderer->addWorld(scene));
  const auto id = get(renderer->addView(handle));
  world::World world(scene);

  ShotResult result;
  render::Frame frame;
  ProgressBar bar("rendering");
  double advance = options.time;  // then the world stands still
  do {
    auto changes = world.beginTick(std::exchange(advance, 0.0));
    changes.environment = view.light;
    const render::ViewRequest request{id, view.camera, settings};
    frame = std::move(get(renderer->tick(handle, changes, {&request, 1})).front());
    result.gpu_ms += frame.stats.gpu_ms;
    result.rays += frame.stats.rays.total();
    bar.show(double(frame.stats.accumulated) / samples,
             std::to_string(frame.stats.accumulated) + "/" + std::to_string(samples) + " samples");
  } while (frame.stats.accumulated < samples);
  result.bytes = encode(frame, options);
  result.samples = frame.stats.accumulated;
  result.exposure = frame.stats.exposure;
  frame.pixels.reset();
  renderer->removeView(id);
  renderer->removeWorld(handle);
  return result;
}

}  // namespace helio::cli
