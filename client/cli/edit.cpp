// helio edit: changes to a world from the command line.
#include <cmath>
#include <cstdio>
#include <memory>

#include "cli/command.h"

namespace helio::cli {
namespace {

struct EditOptions {
  std::string world, request_id, prefab;
  std::vector<float> at;
  std::vector<uint64_t> ids;
  float yaw = 0, scale = 1, radius = 0;
  double elevation = 60, azimuth = 150;
  uint64_t id = 0;
  bool pause = false, resume = false;
  std::optional<double> rate, seek;
  std::optional<uint64_t> expected_seq;
};
using Options = std::shared_ptr<EditOptions>;

/// Position, a turn about y in degrees, scale: eight numbers.
template <typename Numbers>
void addPlacement(const float* at, float yaw, float scale, Numbers* out) {
  const float half = static_cast<float>(radians(yaw)) / 2;
  for (const float number : {at[0], at[1], at[2], 0.0f, std::sin(half), 0.0f, std::cos(half), scale}) out->Add(number);
}

void send(const Common& common, const EditOptions& options, const v1::Edit& edit) {
  client::Connection connection(common.server);
  v1::ApplyEditsRequest request;
  request.set_world(options.world);
  request.set_request_id(options.request_id);
  if (options.expected_seq) request.set_expected_seq(*options.expected_seq);
  *request.add_edits() = edit;
  const auto answer = get(connection.apply(std::move(request)));
  if (common.json) {
    Json built = Json::array();
    for (const auto& range : answer.built()) built.push_back({{"first", range.first()}, {"count", range.count()}});
    return print({{"schema", "heliograph.edit/1"},
                  {"world", options.world},
                  {"seq", answer.seq()},
                  {"epoch", answer.epoch()},
                  {"built", built},
                  {"destroyed", answer.destroyed()},
                  {"replayed", answer.replayed()}});
  }
  std::printf("seq %llu", static_cast<unsigned long long>(answer.seq()));
  for (const auto& range : answer.built())
    std::printf(", built ids %llu to %llu", static_cast<unsigned long long>(range.first()),
                static_cast<unsigned long long>(range.first() + range.count() - 1));
  if (answer.destroyed() > 0) std::printf(", destroyed %llu", static_cast<unsigned long long>(answer.destroyed()));
  std::printf("%s\n", answer.replayed() ? " (had been applied before)" : "");
}

CLI::App* addCommand(CLI::App& edit, Common& common, const Options& options, const char* name, const char* help) {
  auto* command = edit.add_subcommand(name, help);
  addCommon(*command, common);
  command->add_option("world", options->world)->required();
  command->add_option("--request-id", options->request_id, "repeat with the same one and nothing is done twice");
  command->add_option("--expected-seq", options->expected_seq, "fail unless the world is at this sequence number");
  return command;
}

}  // namespace

void addEdit(CLI::App& app, Common& common) {
  auto* edit = app.add_subcommand("edit", "Build, destroy, move, set the sun and the time.");
  edit->require_subcommand(1);
  edit->footer(R"(Examples:
  helio edit build city house_03 --at 10 0 25 --yaw 90
  helio edit build city tree_birch --at 0 0 0 --at 5 0 0      (several at once)
  helio edit destroy city 1041 1042
  helio edit destroy-region city --at 10 25 --radius 40
  helio edit move city 1041 --at 12 0 25
  helio edit sun city --elevation 5 --azimuth 250
  helio edit time city --pause
  helio edit time city --resume --rate 0.25 --seek 3600
Positions are metres, y up; angles are degrees. helio prefabs WORLD lists what can be built.)");
  const auto options = std::make_shared<EditOptions>();

  auto* build = addCommand(*edit, common, options, "build", "Place instances of a prefab.");
  build->add_option("prefab", options->prefab)->required();
  build->add_option("--at", options->at, "x y z, repeatable")->required()->expected(-1)->take_all();
  build->add_option("--yaw", options->yaw, "degrees about the vertical")->capture_default_str();
  build->add_option("--scale", options->scale, "(0, 1000]")->capture_default_str();
  build->callback([&common, options] {
    if (options->at.size() % 3 != 0) throw Stop{"--at takes three numbers: x y z in metres"};
    v1::Edit message;
    message.mutable_build()->set_prefab(options->prefab);
    for (size_t i = 0; i < options->at.size(); i += 3)
      addPlacement(&options->at[i], options->yaw, options->scale, message.mutable_build()->mutable_placements());
    send(common, *options, message);
  });

  auto* destroy = addCommand(*edit, common, options, "destroy", "Remove instances by id.");
  destroy->add_option("ids", options->ids)->required();
  destroy->callback([&common, options] {
    v1::Edit message;
    message.mutable_destroy()->mutable_ids()->Add(options->ids.begin(), options->ids.end());
    send(common, *options, message);
  });

  auto* region = addCommand(*edit, common, options, "destroy-region", "Remove what users may build, within a radius.");
  region->add_option("--at", options->at, "x z")->required()->expected(2);
  region->add_option("--radius", options->radius, "metres")->required();
  region->callback([&common, options] {
    v1::Edit message;
    auto& circle = *message.mutable_destroy_region();
    circle.set_x(options->at[0]);
    circle.set_z(options->at[1]);
    circle.set_radius(options->radius);
    send(common, *options, message);
  });

  auto* move = addCommand(*edit, common, options, "move", "Move one instance.");
  move->add_option("id", options->id)->required();
  move->add_option("--at", options->at, "x y z")->required()->expected(3);
  move->add_option("--yaw", options->yaw, "degrees about the vertical")->capture_default_str();
  move->add_option("--scale", options->scale, "(0, 1000]")->capture_default_str();
  move->callback([&common, options] {
    v1::Edit message;
    message.mutable_move()->set_id(options->id);
    addPlacement(options->at.data(), options->yaw, options->scale, message.mutable_move()->mutable_placement());
    send(common, *options, message);
  });

  auto* sun = addCommand(*edit, common, options, "sun", "Set the sun and the sky that goes with it.");
  sun->add_option("--elevation", options->elevation, "degrees above the horizon, [-90, 90]")->capture_default_str();
  sun->add_option("--azimuth", options->azimuth, "degrees from +z towards +x")->capture_default_str();
  sun->callback([&common, options] {
    v1::Edit message;
    auto& daylight = *message.mutable_set_sun()->mutable_daylight();
    daylight.set_elevation(static_cast<float>(radians(options->elevation)));
    daylight.set_azimuth(static_cast<float>(radians(options->azimuth)));
    send(common, *options, message);
  });

  auto* time = addCommand(*edit, common, options, "time", "Pause, resume, speed up or seek world time, for everybody.");
  auto* pause = time->add_flag("--pause", options->pause, "everything that moves stands still");
  time->add_flag("--resume", options->resume)->excludes(pause);
  time->add_option("--rate", options->rate, "seconds of world time a second, [0, 100]");
  time->add_option("--seek", options->seek, "world time in seconds, [0, 1e9]");
  time->callback([&common, options] {
    v1::Edit message;
    auto& set = *message.mutable_set_time();
    if (options->pause || options->resume) set.set_paused(options->pause);
    if (options->rate) set.set_rate(*options->rate);
    if (options->seek) set.set_seek(*options->seek);
    send(common, *options, message);
  });
}

}  // namespace helio::cli
