// Settings of a view by name, for comparing one with another on the command line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "render/renderer.h"

namespace helio::bench {

/// Adds --set NAME=VALUE, any number of times.
void addSettingOptions(CLI::App& command, std::vector<std::string>& assignments);

/// Carries them out. Errors: invalid: an unknown name (the known ones are listed), a value that is no number.
Result<void> apply(const std::vector<std::string>& assignments, render::ViewSettings& settings);

}  // namespace helio::bench
