// helio shot: one picture.
#include "cli/shot.h"

#include <cstdio>
#include <memory>

#include "cli/progress.h"

namespace helio::cli {
namespace {

ShotResult shootRemotely(const Common& common, const ShotOptions& options) {
  if (options.sun_elevation)
    throw Stop{"--sun-elevation works with --local only; helio edit sun " + options.world + " sets a server's sun"};
  client::Connection connection(common.server);
  v1::RenderRequest request;
  request.set_world(options.world);
  const Size size = parseSize(options.size);
  request.set_width(size.width);
  request.set_height(size.height);
  request.set_mode(parseMode(options.mode));
  request.set_primary(parsePrimary(options.primary));
  request.set_bounces(options.bounces);
  request.set_samples(options.samples.value_or(kShotSamples));
  request.set_materials(parseMaterials(options.materials));
  *request.mutable_light_transport() = options.light;
  options.approximations.put(request);
  request.mutable_exposure()->set_mode(options.fixed_exposure ? v1::EXPOSURE_MODE_FIXED : v1::EXPOSURE_MODE_AUTOMATIC);
  request.mutable_exposure()->set_ev(options.exposure_ev);
  request.set_codec(codecOf(options.out));
  request.set_jpeg_quality(static_cast<uint32_t>(options.quality));
  options.put(request);
  ProgressBar bar("rendering");
  const auto picture = get(connection.render(request, [&](uint32_t samples, uint32_t wanted) {
    bar.show(double(samples) / wanted, std::to_string(samples) + "/" + std::to_string(wanted) + " samples");
  }));
  const auto& header = picture.header;
  const auto& rays = header.rays();
  return {picture.bytes, header.samples(), header.gpu_ms(), header.exposure(),
          rays.primary() + rays.bounce() + rays.shadow() + rays.retrace()};
}

void shoot(const Common& common, const ShotOptions& options) {
  codecOf(options.out);  // before any work
  if (options.position.empty() != options.target.empty()) throw Stop{"--position and --target go together"};
  if (!options.position.empty() && options.position == options.target)
    throw Stop{"--position and --target are the same point; there is no direction to look in"};
  if (!options.position.empty() && !options.camera.empty())
    throw Stop{"give either --camera or --position and --target"};
  if (!options.spec.empty() && !options.local) throw Stop{"--spec is rendered in this process: add --local"};
  if (!options.local && options.world.empty()) throw Stop{"name a world of the server, or render with --local"};
  const ShotResult result = options.local ? shootLocally(options) : shootRemotely(common, options);
  writeFile(options.out, result.bytes);
  if (common.json)
    return print({{"schema", "heliograph.shot/1"},
                  {"file", options.out},
                  {"bytes", result.bytes.size()},
                  {"samples", result.samples},
                  {"gpu_ms", result.gpu_ms},
                  {"rays", result.rays},
                  {"exposure", result.exposure}});
  std::printf("%s: %u samples a pixel, %.1f ms on the GPU, %.2f million rays\n", options.out.c_str(), result.samples,
              result.gpu_ms, double(result.rays) / 1e6);
}

}  // namespace

v1::Codec codecOf(const std::string& file) {
  const auto ends = [&](const char* end) {
    const std::string suffix = end;
    return file.size() > suffix.size() && file.compare(file.size() - suffix.size(), suffix.size(), suffix) == 0;
  };
  if (ends(".png")) return v1::CODEC_PNG;
  if (ends(".jpg") || ends(".jpeg")) return v1::CODEC_JPEG;
  if (ends(".pfm")) return v1::CODEC_PFM;
  throw Stop{"--out is \"" + file + "\"; its name must end in .png, .jpg or .pfm"};
}

void addShot(CLI::App& app, Common& common) {
  auto options = std::make_shared<ShotOptions>();
  auto* shot =
      app.add_subcommand("shot", "One picture: from a running server, or with --local rendered in this process.");
  addCommon(*shot, common);
  shot->footer(R"(Examples:
  helio shot city --camera high_above --out above.png
  helio shot city --position 0 20 60 --target 0 5 0 --size 1280x720 --spp 256 --out city.jpg
  helio shot --local --city 10000 --camera city_at_sunset --spp 64 --out sunset.png
  helio shot --local --city 1000 --animated 400 --camera animated_models --time 12.5 --out walkers.png
  helio shot --local --gltf model.glb --spp 1024 --out radiance.pfm
  helio shot --local --spec cornell.json --spp 256 --fixed-exposure --out cornell.pfm
  helio shot city --camera forest --materials normals --out normals.png
A .pfm holds linear radiance. A named camera is seen in its own light with --local, in the world's on a server.)");
  shot->add_option("world", options->world, "a world of the server");
  shot->add_option("--camera", options->camera, "a named camera; helio worlds show WORLD lists them");
  shot->add_option("--position", options->position, "x y z in metres")->expected(3);
  shot->add_option("--target", options->target, "x y z in metres")->expected(3);
  shot->add_option("--vfov", options->vfov, "vertical angle in degrees, with --position")->capture_default_str();
  shot->add_option("--size", options->size, "WIDTHxHEIGHT in pixels, 16 to 8192 each")->capture_default_str();
  shot->add_option("--spp", options->samples, "samples a pixel; default: 16, or what --spec asks for")
      ->check(CLI::Range(1u, 65'536u));
  shot->add_option("--mode", options->mode, "reference or hybrid")
      ->capture_default_str()
      ->check(CLI::IsMember({"reference", "hybrid"}));
  shot->add_option("--primary", options->primary, "raster or traced, in hybrid mode")
      ->capture_default_str()
      ->check(CLI::IsMember({"raster", "traced"}));
  shot->add_option("--bounces", options->bounces, "0 to 32")->capture_default_str()->check(CLI::Range(0u, 32u));
  addMaterials(*shot, options->materials);
  addLightTransport(*shot, options->light);
  addApproximations(*shot, options->approximations);
  shot->add_option("--exposure", options->exposure_ev, "exponent of two; compensation of the automatic exposure")
      ->capture_default_str();
  shot->add_flag("--fixed-exposure", options->fixed_exposure, "radiance is scaled by 2^exposure and nothing else");
  shot->add_option("--quality", options->quality, "of a JPEG, 1 to 100")
      ->capture_default_str()
      ->check(CLI::Range(1, 100));
  shot->add_option("--out", options->out, "file.png, .jpg or .pfm")->capture_default_str();
  shot->add_flag("--local", options->local, "render here, without a server");
  shot->add_option("--city", options->city, "--local: a city of so many instances");
  shot->add_option("--seed", options->seed, "--local: of the city")->capture_default_str();
  shot->add_option("--animated", options->animated, "--local: moving units of the city, 0 to 10,000")
      ->capture_default_str();
  shot->add_option("--time", options->time, "--local: the world's time in seconds, at which everything stands")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e9));
  shot->add_option("--gltf", options->gltf, "--local: a glTF file");
  auto* spec =
      shot->add_option("--spec", options->spec,
                       "--local: a SPEC.json, as of helio-bench fidelity: model, light, camera, size, samples, "
                       "bounces and materials");
  for (const char* other :
       {"--city", "--gltf", "--camera", "--position", "--target", "--size", "--bounces", "--mode", "--materials"})
    spec->excludes(shot->get_option(other));
  shot->add_option("--sun-elevation", options->sun_elevation, "--local: degrees above the horizon");
  shot->add_option("--sun-azimuth", options->sun_azimuth, "--local: degrees from +z towards +x")->capture_default_str();
  shot->add_option("--device", options->device, "--local: part of a device's name, cpu or gpu")
      ->envname("HELIOGRAPH_DEVICE");
  shot->add_flag("--validation", options->validation, "--local: Vulkan's validation layer");
  shot->callback([&common, options] { shoot(common, *options); });
}

}  // namespace helio::cli
