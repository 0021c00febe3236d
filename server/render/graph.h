// A graph of passes: each declares what it reads and writes; the graph places the barriers, times every pass, and
// records them in the order in which they were added. A pass that nothing calls for is simply not added.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gpu/commands.h"

namespace helio::render {

/// Names a resource within one graph: the address of what it stands for (a buffer, an image, a structure).
using Resource = const void*;

struct Access {
  Resource resource;
  gpu::Use use;
};

class Graph {
 public:
  static constexpr int kShared = -1;  ///< owner of the passes that serve all views

  /// `name`: file, timer and telemetry field. `owner`: index of the view, or kShared.
  void add(std::string name, int owner, std::vector<Access> accesses, std::function<void(gpu::Commands&)> record);

  /// Records all passes with the barriers between them. Images stay in layout GENERAL, so memory barriers are all it
  /// takes.
  void record(gpu::Commands& commands) const;

  struct Pass {
    std::string name;
    int owner;
    std::vector<Access> accesses;
    std::function<void(gpu::Commands&)> record;
  };
  const std::vector<Pass>& passes() const { return passes_; }

 private:
  std::vector<Pass> passes_;
};

}  // namespace helio::render
