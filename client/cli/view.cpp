// helio view: a viewer without a window. Frames and their telemetry go to a folder.
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include "cli/command.h"
#include "cli/progress.h"
#include "cli/recording.h"

namespace helio::cli {
namespace {

struct ViewOptions {
  std::string world, script, camera, out = "frames", size = "640x360", mode = "hybrid", primary = "raster",
                                     materials = "none";
  bool tour = false;
  uint32_t frames = 0, bounces = 3, samples = 1, max_fps = 30, quality = 80, max_kbps = 0, reattach = 30;
  double seconds = 0, max_frame_ms = 0, max_error = 0;
  v1::LightTransport light;
  Approximations approximations;
};

v1::Settings settingsOf(const ViewOptions& options) {
  const Size size = parseSize(options.size);
  v1::Settings settings;
  settings.set_width(size.width);
  settings.set_height(size.height);
  settings.set_mode(parseMode(options.mode));
  settings.set_primary(parsePrimary(options.primary));
  settings.set_bounces(options.bounces);
  settings.set_samples(options.samples);
  settings.set_materials(parseMaterials(options.materials));
  *settings.mutable_light_transport() = options.light;
  options.approximations.put(settings);
  if (options.max_frame_ms > 0) settings.mutable_goal()->set_max_frame_ms(static_cast<float>(options.max_frame_ms));
  if (options.max_error > 0) settings.mutable_goal()->set_max_error(static_cast<float>(options.max_error));
  settings.mutable_stream()->set_max_fps(options.max_fps);
  settings.mutable_stream()->set_jpeg_quality(options.quality);
  settings.mutable_stream()->set_max_kbps(options.max_kbps);
  return settings;
}

Tour tourOf(const ViewOptions& options, client::Connection& connection, const v1::World& world) {
  Tour tour;
  if (!options.script.empty()) {
    std::ifstream file(options.script);
    std::stringstream text;
    text << file.rdbuf();
    if (!file) throw Stop{"cannot read --script " + options.script};
    tour = get(parseTour(text.str()));
  } else if (options.tour) {
    tour = usualTour(world, get(connection.prefabs(world.world())));
  }
  if (options.seconds > 0 && !tour.steps.empty()) tour.last(options.seconds);
  return tour;
}

const v1::Camera& firstCamera(const v1::World& world, const std::string& name) {
  for (const auto& named : world.cameras())
    if (name.empty() || named.name() == name) return named.camera();
  throw Stop{"world \"" + world.world() + "\" has no camera \"" + name + "\"; helio worlds show lists them"};
}

Json describe(const ViewOptions& options, const v1::ServerInfo& server, const v1::Settings& settings) {
  return {{"schema", "heliograph.view/1"},
          {"world", options.world},
          {"server",
           {{"version", server.version()},
            {"device", server.device()},
            {"driver", server.driver()},
            {"cpu_device", server.cpu_device()}}},
          {"settings",
           {{"width", settings.width()},
            {"height", settings.height()},
            {"mode", options.mode},
            {"primary", options.primary},
            {"bounces", settings.bounces()},
            {"samples", settings.samples()},
            {"materials", options.materials},
            {"max_frame_ms", settings.goal().has_max_frame_ms() ? Json(options.max_frame_ms) : Json()},
            {"max_error", settings.goal().has_max_error() ? Json(options.max_error) : Json()},
            {"max_fps", settings.stream().max_fps()},
            {"jpeg_quality", settings.stream().jpeg_quality()}}},
          {"script", !options.script.empty() ? Json(options.script)
                     : options.tour          ? Json("usual")
                                             : Json()}};
}

void view(const Common& common, const ViewOptions& options) {
  if (!options.script.empty() && options.tour) throw Stop{"give either --script or --tour"};
  client::Connection connection(common.server);
  const auto server = get(connection.serverInfo());
  const auto world = get(connection.readyWorld(options.world));
  Tour tour = tourOf(options, connection, world);
  const bool touring = !tour.steps.empty();
  if (!touring && options.frames == 0 && options.seconds == 0)
    throw Stop{"say how long: --script FILE, --tour, --frames N or --seconds S"};
  std::error_code error;
  const std::filesystem::path folder = options.out;
  std::filesystem::create_directories(folder, error);
  if (error) throw Stop{"cannot make the folder " + options.out + ": " + error.message()};

  const v1::Settings settings = settingsOf(options);
  const v1::Camera& first = firstCamera(world, options.camera);
  const auto session = get(client::ViewerSession::attach(
      connection, {options.world, settings, first, std::chrono::seconds(options.reattach)}));
  const auto start = client::Clock::now();
  const double duration = touring ? tour.seconds() : options.seconds;
  const auto pilot = get(Pilot::prepare(connection, *session, world, std::move(tour)));

  // The pilot flies on a thread of its own; when it lands, the stream ends.
  Result<void> flown;
  std::thread pilot_thread;
  if (touring)
    pilot_thread = std::thread([&] {
      flown = pilot->run();
      session->leave();
    });
  struct Join {
    Pilot& pilot;
    std::thread& thread;
    ~Join() {
      pilot.stop();
      if (thread.joinable()) thread.join();
    }
  } join{*pilot, pilot_thread};

  Recording recording(start);
  {
    ProgressBar bar("view");
    while (auto received = get(session->next())) {
      const auto& frame = received->frame;
      char name[32];
      std::snprintf(name, sizeof name, "frame_%06llu.jpg", static_cast<unsigned long long>(recording.frames()) + 1);
      writeFile((folder / name).string(), frame.data());
      const auto motion_to_photon = session->shown(*received, received->arrived);
      const auto stored = client::Clock::now();
      const double present_ms = std::chrono::duration<double, std::milli>(stored - received->arrived).count();
      const auto seen = pilot->viewOf(frame.camera_id());
      recording.add(frame, {name, seen ? *seen : client::fromWire(first), stored, present_ms, motion_to_photon});

      const double elapsed = std::chrono::duration<double>(stored - start).count();
      const double done = options.frames > 0 ? double(recording.frames()) / options.frames : elapsed / duration;
      char note[64];
      std::snprintf(note, sizeof note, "%zu frames, %.1f/s", recording.frames(), recording.framesPerSecond());
      bar.show(done, note);
      if ((options.frames > 0 && recording.frames() >= options.frames) ||
          (!touring && duration > 0 && elapsed >= duration))
        break;
    }
  }
  pilot->stop();
  session->leave();
  if (pilot_thread.joinable()) pilot_thread.join();
  get(flown);
  if (recording.frames() == 0) throw Stop{"no frame arrived before the end; view for longer"};

  Json document = describe(options, server, settings);
  document.update(recording.document(pilot->marks()));
  writeFile((folder / "telemetry.json").string(), document.dump(1) + "\n");
  if (common.json) {
    document.erase("frames");
    document["out"] = options.out;
    return print(document);
  }
  const auto& summary = document["summary"];
  std::printf("%s: %zu frames, %.2f frames/s, %llu dropped; motion to photon %s ms, edit to picture %s ms (medians)\n",
              options.out.c_str(), recording.frames(), recording.framesPerSecond(),
              static_cast<unsigned long long>(recording.dropped()),
              summary["motion_to_photon_ms"]["median"].dump().c_str(),
              summary["edit_to_picture_ms"]["median"].dump().c_str());
}

}  // namespace

void addView(CLI::App& app, Common& common) {
  auto options = std::make_shared<ViewOptions>();
  auto* command =
      app.add_subcommand("view", "Attach as a viewer and write the frames to a folder, with telemetry.json.");
  addCommon(*command, common);
  command->footer(R"(Examples:
  helio view city --script scenes/tours/demo.json --out frames
  helio view city --tour --size 320x180 --seconds 20
  helio view city --camera forest --frames 10 --json
  helio view city --tour --max-frame-ms 16 --out frames
client/cli/README.md documents tours and telemetry.json.)");
  command->add_option("world", options->world, "a world of the server")->required();
  command->add_option("--script", options->script, "a tour");
  command->add_flag("--tour", options->tour, "the usual tour: fly, two jumps, build, destroy");
  command->add_option("--camera", options->camera, "a named camera to begin with");
  command->add_option("--frames", options->frames, "end after so many frames");
  command->add_option("--seconds", options->seconds, "last so long; a tour is scaled to it")
      ->check(CLI::Range(0.0, 86'400.0));
  command->add_option("--size", options->size, "WIDTHxHEIGHT in pixels, 16 to 8192 each")->capture_default_str();
  command->add_option("--mode", options->mode, "hybrid or reference")
      ->capture_default_str()
      ->check(CLI::IsMember({"hybrid", "reference"}));
  command->add_option("--primary", options->primary, "raster or traced")
      ->capture_default_str()
      ->check(CLI::IsMember({"raster", "traced"}));
  command->add_option("--bounces", options->bounces, "0 to 32")->capture_default_str();
  command->add_option("--spp", options->samples, "paths a pixel a frame, 1 to 64")->capture_default_str();
  auto* max_frame_ms =
      command
          ->add_option("--max-frame-ms", options->max_frame_ms,
                       "a goal in the place of --bounces and --spp: the best picture in so many GPU milliseconds")
          ->check(CLI::Range(1e-3, 10'000.0));
  command
      ->add_option("--max-error", options->max_error,
                   "likewise: the quickest picture of so small a relative mean square error")
      ->check(CLI::Range(1e-6, 10.0))
      ->excludes(max_frame_ms);
  addMaterials(*command, options->materials);
  addLightTransport(*command, options->light);
  addApproximations(*command, options->approximations);
  command->add_option("--max-fps", options->max_fps, "frames a second")->capture_default_str();
  command->add_option("--quality", options->quality, "of the JPEGs, 1 to 100")->capture_default_str();
  command->add_option("--max-kbps", options->max_kbps, "thousands of bits a second; 0: what the connection carries")
      ->capture_default_str();
  command->add_option("--reattach", options->reattach, "seconds to try to attach again when the connection breaks")
      ->capture_default_str()
      ->check(CLI::Range(0u, 86'400u));
  command->add_option("--out", options->out, "folder")->capture_default_str();
  command->callback([&common, options] { view(common, *options); });
}

}  // namespace helio::cli
