// helio top: live telemetry in the terminal.
#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <memory>

#include "cli/command.h"

namespace helio::cli {
namespace {

struct TopOptions {
  std::string world;
  double interval = 1.0;
  bool once = false;
};

__attribute__((format(printf, 2, 3))) void line(std::string& out, const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  out += text;
  out += '\n';
}

uint64_t total(const v1::RayCounts& rays) { return rays.primary() + rays.bounce() + rays.shadow() + rays.retrace(); }

void describe(const v1::ViewerTelemetry& viewer, std::string& out) {
  line(out,
       "  viewer %-4llu %ux%u  %5.1f frames/s  %6.2f MB/s  %llu frames, %llu dropped  in flight %u of %u  round trip "
       "%.1f ms",
       static_cast<unsigned long long>(viewer.viewer()), viewer.width(), viewer.height(),
       double(viewer.frames_per_second()), double(viewer.bytes_per_second()) / 1e6,
       static_cast<unsigned long long>(viewer.frames()), static_cast<unsigned long long>(viewer.dropped()),
       viewer.unacknowledged(), viewer.window(), double(viewer.round_trip_ms()));
  line(out, "    stages (ms)  camera wait %.1f  tick %.1f  mailbox %.1f  encode %.1f  write %.1f",
       viewer.camera_wait_us() / 1e3, viewer.tick_us() / 1e3, viewer.mailbox_us() / 1e3, viewer.encode_us() / 1e3,
       viewer.write_us() / 1e3);
  std::string passes;
  for (const auto& pass : viewer.passes()) {
    char text[96];
    std::snprintf(text, sizeof text, "  %s %.2f", pass.name().c_str(), double(pass.ms()));
    passes += text;
  }
  line(out, "    gpu %.2f ms %s", double(viewer.gpu_ms()), passes.c_str());
  line(out,
       "    rays %.2f M (primary %.2f, bounce %.2f, shadow %.2f, retrace %.2f)  memory MB: raster %.0f, ray tracing "
       "%.0f, path tracing %.0f",
       double(total(viewer.rays())) / 1e6, double(viewer.rays().primary()) / 1e6, double(viewer.rays().bounce()) / 1e6,
       double(viewer.rays().shadow()) / 1e6, double(viewer.rays().retrace()) / 1e6,
       double(viewer.memory().raster()) / 1e6, double(viewer.memory().ray_tracing()) / 1e6,
       double(viewer.memory().path_tracing()) / 1e6);
  for (const auto& kind : viewer.dropped_samples())
    line(out, "    %llu samples were dropped: %s, found by %s", static_cast<unsigned long long>(kind.samples()),
         kind.cause().c_str(), kind.pass().c_str());
  for (const auto& effect : viewer.effects())
    line(out, "    effect %-20s %9llu instances  %8.2f MB  %6.2f ms", effect.name().c_str(),
         static_cast<unsigned long long>(effect.instances()), double(effect.memory_bytes()) / 1e6,
         double(effect.pass_ms()));
}

/// As text: JSON's numbers end at 2^53.
std::string hexadecimal(uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string describe(const v1::TelemetrySample& sample, const std::string& server) {
  std::string out;
  line(out, "%s  up %.0f s  %.0f MB resident", server.c_str(), sample.uptime(), double(sample.resident_bytes()) / 1e6);
  for (const auto& world : sample.worlds()) {
    line(out, "world %-16s %llu instances  seq %llu  checksum %s  %.1f ticks/s of %.1f ms  edit to picture %.0f ms",
         world.world().c_str(), static_cast<unsigned long long>(world.instances()),
         static_cast<unsigned long long>(world.seq()), hexadecimal(world.checksum()).c_str(),
         double(world.ticks_per_second()), double(world.tick_ms()), double(world.edit_to_picture_ms()));
    for (const auto& viewer : world.viewers()) describe(viewer, out);
  }
  return out;
}

Json toJson(const v1::ViewerTelemetry& viewer) {
  Json passes = Json::object(), effects = Json::array(), dropped_samples = Json::array();
  for (const auto& pass : viewer.passes()) passes[pass.name()] = pass.ms();
  for (const auto& effect : viewer.effects())
    effects.push_back({{"name", effect.name()},
                       {"instances", effect.instances()},
                       {"memory_bytes", effect.memory_bytes()},
                       {"pass_ms", effect.pass_ms()}});
  for (const auto& kind : viewer.dropped_samples())
    dropped_samples.push_back({{"pass", kind.pass()}, {"cause", kind.cause()}, {"samples", kind.samples()}});
  const auto& rays = viewer.rays();
  const auto& memory = viewer.memory();
  return {
      {"viewer", viewer.viewer()},
      {"size", {viewer.width(), viewer.height()}},
      {"frames", viewer.frames()},
      {"dropped", viewer.dropped()},
      {"frames_per_second", viewer.frames_per_second()},
      {"bytes_per_second", viewer.bytes_per_second()},
      {"unacknowledged", viewer.unacknowledged()},
      {"window", viewer.window()},
      {"round_trip_ms", viewer.round_trip_ms()},
      {"applied_seq", viewer.applied_seq()},
      {"passes", passes},
      {"gpu_ms", viewer.gpu_ms()},
      {"rays",
       {{"primary", rays.primary()},
        {"bounce", rays.bounce()},
        {"shadow", rays.shadow()},
        {"retrace", rays.retrace()}}},
      {"effects", effects},
      {"dropped_samples", dropped_samples},
      {"memory",
       {{"raster", memory.raster()}, {"ray_tracing", memory.ray_tracing()}, {"path_tracing", memory.path_tracing()}}},
      {"stages_us",
       {{"camera_wait", viewer.camera_wait_us()},
        {"tick", viewer.tick_us()},
        {"mailbox", viewer.mailbox_us()},
        {"encode", viewer.encode_us()},
        {"write", viewer.write_us()}}}};
}

Json toJson(const v1::TelemetrySample& sample) {
  Json worlds = Json::array();
  for (const auto& world : sample.worlds()) {
    Json viewers = Json::array();
    for (const auto& viewer : world.viewers()) viewers.push_back(toJson(viewer));
    worlds.push_back({{"world", world.world()},
                      {"instances", world.instances()},
                      {"seq", world.seq()},
                      {"checksum", hexadecimal(world.checksum())},
                      {"ticks", world.ticks()},
                      {"ticks_per_second", world.ticks_per_second()},
                      {"tick_ms", world.tick_ms()},
                      {"edit_to_picture_ms", world.edit_to_picture_ms()},
                      {"edit_to_picture_worst_ms", world.edit_to_picture_worst_ms()},
                      {"viewers", viewers}});
  }
  return {{"schema", "heliograph.top/1"},
          {"uptime", sample.uptime()},
          {"resident_bytes", sample.resident_bytes()},
          {"worlds", worlds}};
}

void top(const Common& common, const TopOptions& options) {
  client::Connection connection(common.server);
  v1::WatchTelemetryRequest request;
  request.set_world(options.world);
  request.set_interval_ms(static_cast<uint32_t>(options.interval * 1000));
  const bool terminal = isatty(STDOUT_FILENO) != 0 && !common.json && !options.once;
  // Rates are differences between two samples: --once shows the second.
  int samples = 0;
  get(connection.watch(request, [&](const v1::TelemetrySample& sample) {
    ++samples;
    if (options.once && samples < 2) return true;
    if (terminal) std::fputs("\x1b[H\x1b[2J", stdout);
    if (common.json) std::printf("%s\n", options.once ? toJson(sample).dump(2).c_str() : toJson(sample).dump().c_str());
    else std::fputs(describe(sample, connection.address()).c_str(), stdout);
    std::fflush(stdout);
    return !options.once;
  }));
}

}  // namespace

void addTop(CLI::App& app, Common& common) {
  auto options = std::make_shared<TopOptions>();
  auto* command = app.add_subcommand("top", "Live telemetry: worlds, viewers, passes, effects, memory.");
  addCommon(*command, common);
  command->footer(R"(Examples:
  helio top
  helio top city --interval 0.5
  helio top --once --json       (one document; without --once one a line, until interrupted))");
  command->add_option("world", options->world, "only this world");
  command->add_option("--interval", options->interval, "seconds, 0.1 to 60")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 60.0));
  command->add_flag("--once", options->once, "print once and end");
  command->callback([&common, options] { top(common, *options); });
}

}  // namespace helio::cli
