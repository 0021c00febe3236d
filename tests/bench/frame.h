// `helio-bench frame`: the time of frames, whole and by pass, and what it is spent on.
#pragma once

#include <string>
#include <vector>

#include "bench/command.h"
#include "bench/stage.h"
#include "render/renderer.h"

namespace helio::bench {

struct FrameOptions {
  StageOptions stage;
  render::ViewSettings view;
  std::vector<render::Primary> primaries;  ///< measured in turn, frame by frame
  uint32_t frames = 20;
  uint32_t warmup = 5;
  render::RendererOptions renderer;
  std::string picture;  ///< a file for the last picture; empty: none
  bool json = false;
};

/// Adds the subcommand, which becomes `chosen` when it is the one on the command line.
void addFrameCommand(CLI::App& app, const std::string& command_line, Action& chosen);

}  // namespace helio::bench
