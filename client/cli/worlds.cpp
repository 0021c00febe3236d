// helio worlds, helio prefabs: what there is.
#include <cstdio>
#include <iostream>
#include <memory>

#include "cli/command.h"
#include "cli/progress.h"
#include "store/wal_repair.h"

namespace helio::cli {
namespace {

const char* nameOf(v1::WorldState state) {
  switch (state) {
    case v1::WORLD_STATE_LOADING:
      return "loading";
    case v1::WORLD_STATE_READY:
      return "ready";
    case v1::WORLD_STATE_FAILED:
      return "failed";
    default:
      return "unknown";
  }
}

Json vec(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json describe(const v1::World& world) {
  Json out = {{"world", world.world()},
              {"state", nameOf(world.state())},
              {"source", world.source()},
              {"instances", world.instances()},
              {"seq", world.seq()},
              {"epoch", world.epoch()},
              {"viewers", world.viewers()},
              {"time", world.time()},
              {"time_rate", world.time_rate()},
              {"time_paused", world.time_paused()}};
  if (!world.error().empty()) out["error"] = world.error();
  if (world.has_bounds()) out["bounds"] = {{"min", vec(world.bounds().min())}, {"max", vec(world.bounds().max())}};
  Json cameras = Json::array();
  for (const auto& named : world.cameras()) {
    const auto& pose = named.camera().pose();
    cameras.push_back({{"name", named.name()},
                       {"description", named.description()},
                       {"pose", std::vector<float>(pose.begin(), pose.end())},
                       {"vfov", named.camera().vfov()}});
  }
  out["cameras"] = std::move(cameras);
  return out;
}

void printLine(const v1::World& world) {
  std::printf("%-20s %-8s %9llu instances  seq %-6llu %u viewers  %s\n", world.world().c_str(), nameOf(world.state()),
              static_cast<unsigned long long>(world.instances()), static_cast<unsigned long long>(world.seq()),
              world.viewers(), world.error().empty() ? world.source().c_str() : world.error().c_str());
}

void show(const Common& common, const v1::World& world) {
  if (common.json) {
    Json document = {{"schema", "heliograph.world/1"}};
    document.update(describe(world));
    return print(document);
  }
  printLine(world);
  for (const auto& camera : world.cameras())
    std::printf("  camera %-20s %s\n", camera.name().c_str(), camera.description().c_str());
}

struct CreateOptions {
  std::string name, gltf;
  uint32_t city = 0, animated = 0;
  uint64_t seed = 1;
  bool no_wait = false;
};

void create(const Common& common, const CreateOptions& options) {
  if ((options.city != 0) == !options.gltf.empty()) throw Stop{"give either --city INSTANCES or --gltf PATH"};
  client::Connection connection(common.server);
  v1::CreateWorldRequest request;
  request.set_world(options.name);
  if (options.city != 0) {
    request.mutable_city()->set_instances(options.city);
    request.mutable_city()->set_seed(options.seed);
    request.mutable_city()->set_animated(options.animated);
  } else {
    request.mutable_gltf()->set_path(options.gltf);
  }
  auto world = get(connection.createWorld(request));
  if (!options.no_wait) {
    Spinner spinner("loading " + world.world());
    world = get(connection.readyWorld(world.world(), [&] { spinner.turn(); }));
  }
  show(common, world);
}

struct RepairOptions {
  std::string name, log_folder;
  uint64_t accept_loss = 0;
};

/// A write-ahead log that keeps the whole server from starting.
void repairFolder(const Common& common, const RepairOptions& options) {
  const auto repaired = get(store::repairWal(options.log_folder, options.accept_loss));
  if (common.json)
    return print({{"schema", "heliograph.wal_repair/1"},
                  {"lost_transactions", repaired.lost_transactions},
                  {"kept", repaired.kept.string()}});
  if (repaired.kept.empty()) {
    std::printf("%s: the write-ahead log is not damaged; nothing was changed\n", options.log_folder.c_str());
    return;
  }
  std::printf("%s: %llu transactions at most were lost; the files as they were are in %s\n", options.log_folder.c_str(),
              static_cast<unsigned long long>(repaired.lost_transactions), repaired.kept.c_str());
}

void repair(const Common& common, const RepairOptions& options) {
  if (options.name.empty() == options.log_folder.empty())
    throw Stop{"give either a world of a running server, or --log-dir FOLDER of one that does not start"};
  if (!options.log_folder.empty()) return repairFolder(common, options);
  client::Connection connection(common.server);
  const auto repaired = get(connection.repairWorld(options.name, options.accept_loss));
  Spinner spinner("loading " + options.name);
  const auto world = get(connection.readyWorld(options.name, [&] { spinner.turn(); }));
  if (common.json)
    return print({{"schema", "heliograph.repair/1"},
                  {"world", describe(world)},
                  {"seq", repaired.seq()},
                  {"lost_edits", repaired.lost_edits()},
                  {"forgotten_requests", repaired.forgotten_requests()}});
  std::printf("%s: repaired up to seq %llu; %llu edits lost, %llu requests forgotten\n", options.name.c_str(),
              static_cast<unsigned long long>(repaired.seq()), static_cast<unsigned long long>(repaired.lost_edits()),
              static_cast<unsigned long long>(repaired.forgotten_requests()));
}

}  // namespace

void addWorlds(CLI::App& app, Common& common) {
  auto* worlds = app.add_subcommand("worlds", "List, create, show, repair and delete worlds.");
  worlds->require_subcommand(1);
  worlds->footer(R"(Examples:
  helio worlds list
  helio worlds create city --city 10000 --seed 7
  helio worlds create house --gltf house.glb      (a file under the server's --gltf-root)
  helio worlds show city --json
  helio worlds delete city)");

  auto* list = worlds->add_subcommand("list", "All worlds of the server.");
  addCommon(*list, common);
  list->callback([&common] {
    client::Connection connection(common.server);
    const auto all = get(connection.worlds());
    if (common.json) {
      Json document = {{"schema", "heliograph.worlds/1"}, {"worlds", Json::array()}};
      for (const auto& world : all) document["worlds"].push_back(describe(world));
      return print(document);
    }
    for (const auto& world : all) printLine(world);
  });

  auto options = std::make_shared<CreateOptions>();
  auto* make = worlds->add_subcommand("create", "Make a world, and wait until it is loaded.");
  addCommon(*make, common);
  make->add_option("name", options->name, "its name; the server chooses one when there is none");
  make->add_option("--city", options->city, "a city of so many instances, 1,000 to 1,000,000");
  make->add_option("--seed", options->seed, "of the city")->capture_default_str();
  make->add_option("--animated", options->animated, "moving units of the city, 0 to 10,000")->capture_default_str();
  make->add_option("--gltf", options->gltf, "a glTF file, relative to the server's glTF folder");
  make->add_flag("--no-wait", options->no_wait, "do not wait until it is loaded");
  make->callback([&common, options] { create(common, *options); });

  auto name = std::make_shared<std::string>();
  auto* one = worlds->add_subcommand("show", "One world, with its cameras.");
  addCommon(*one, common);
  one->add_option("name", *name)->required();
  one->callback([&common, name] {
    client::Connection connection(common.server);
    show(common, get(connection.world(*name)));
  });

  auto repair_options = std::make_shared<RepairOptions>();
  auto* mend = worlds->add_subcommand("repair", "Give up what cannot be read of a damaged world, and load the rest.");
  addCommon(*mend, common);
  mend->footer(R"(Examples:
  helio worlds repair city --accept-loss 0        (refused, with the number of edits that it takes)
  helio worlds repair city --accept-loss 12
  helio worlds repair --log-dir /var/lib/heliograph/worlds --accept-loss 3
A world that is DATA_LOSS is repaired on its running server: it keeps every edit up to the first that cannot be read.
With --log-dir the write-ahead log of a stopped server is cut, and N counts transactions: each holds the edits of up to
10 ms. The files as they were stay beside it.)");
  mend->add_option("name", repair_options->name, "a world that failed");
  mend->add_option("--log-dir", repair_options->log_folder, "the log of a server that does not start");
  mend->add_option("--accept-loss", repair_options->accept_loss, "edits that may be lost; more are not")->required();
  mend->callback([&common, repair_options] { repair(common, *repair_options); });

  auto* remove = worlds->add_subcommand("delete", "Forget a world and its edits; its viewers are told.");
  addCommon(*remove, common, false);
  remove->add_option("name", *name)->required();
  remove->callback([&common, name] {
    client::Connection connection(common.server);
    get(connection.deleteWorld(*name));
  });
}

void addPrefabs(CLI::App& app, Common& common) {
  auto world = std::make_shared<std::string>();
  auto* prefabs = app.add_subcommand("prefabs", "What can be built in a world.");
  addCommon(*prefabs, common);
  prefabs->add_option("world", *world)->required();
  prefabs->footer("Examples:\n  helio prefabs city\n  helio prefabs city --json");
  prefabs->callback([&common, world] {
    client::Connection connection(common.server);
    const auto all = get(connection.prefabs(*world));
    if (common.json) {
      Json document = {{"schema", "heliograph.prefabs/1"}, {"world", *world}, {"prefabs", Json::array()}};
      for (const auto& prefab : all)
        document["prefabs"].push_back(
            {{"name", prefab.name()},
             {"category", prefab.category()},
             {"buildable", prefab.buildable()},
             {"triangles", prefab.triangles()},
             {"instances", prefab.instances()},
             {"bounds", {{"min", vec(prefab.bounds().min())}, {"max", vec(prefab.bounds().max())}}}});
      return print(document);
    }
    for (const auto& prefab : all)
      std::printf("%-24s %-12s %6u triangles %9llu instances%s\n", prefab.name().c_str(), prefab.category().c_str(),
                  prefab.triangles(), static_cast<unsigned long long>(prefab.instances()),
                  prefab.buildable() ? "" : "  (not buildable)");
  });
}

}  // namespace helio::cli
