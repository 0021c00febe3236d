// helio: the command line client.
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "cli/command.h"

int main(int argc, char** argv) {
  using namespace helio::cli;
  std::signal(SIGPIPE, SIG_IGN);
  CLI::App app("Looks at worlds of a Heliograph server, and changes them.", "helio");
  app.footer(R"(Examples:
  helio worlds create city --city 10000
  helio shot city --camera city_at_sunset --out sunset.png
  helio view city --script scenes/tours/demo.json --out frames
  helio accuracy --world city --viewer 1 --out accuracy
  helio top
  helio token create "Ann" --scope edit --world city
helio COMMAND --help has the flags and examples of a command.)");
  app.require_subcommand(1);
  Common common;
  common.server = usualServer();
  addWorlds(app, common);
  addPrefabs(app, common);
  addEdit(app, common);
  addShot(app, common);
  addView(app, common);
  addAccuracy(app, common);
  addTop(app, common);
  addLogin(app, common);
  addToken(app, common);
  try {
    app.parse(argc, argv);
    return EXIT_SUCCESS;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "helio: " << error.what() << "; see helio --help\n";
  } catch (const Stop& stop) { std::cerr << "helio: " << stop.message << "\n"; } catch (const std::exception& error) {
    std::cerr << "helio: " << error.what() << "\n";
  }
  return EXIT_FAILURE;
}
