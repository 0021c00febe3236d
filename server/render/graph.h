// A graph of passes: each declares what it reads and writes; the graph places the barriers, times every pass, and
// records them in the order in which they were added. A pass that nothing calls for is simply not added. Passes of the
// second queue run beside those of the first that touch nothing of theirs.
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

  /// `name`: file, timer and telemetry field. `owner`: index of the view, or kShared. `queue`: async, if it takes no
  /// more than a compute queue can do.
  void add(std::string name, int owner, std::vector<Access> accesses, std::function<void(gpu::Commands&)> record,
           gpu::Queue queue = gpu::Queue::main);

  /// Records all passes with the barriers between them. Images stay in layout GENERAL, so memory barriers are all it
  /// takes. Passes of the queue `async` go to `async`, if it is given: each queue waits for the other where a pass
  /// touches what the other's passes wrote, or writes what they touched. `main` is left to be submitted; `async` is
  /// done when `main` is.
  void record(gpu::Commands& main, gpu::Commands* async = nullptr) const;
  /// Waits for what was recorded and submitted; times in the order of the passes.
  std::vector<gpu::TimedPass> finish(gpu::Commands& main, gpu::Commands* async = nullptr) const;

  struct Pass {
    std::string name;
    int owner;
    std::vector<Access> accesses;
    std::function<void(gpu::Commands&)> record;
    gpu::Queue queue;
  };
  const std::vector<Pass>& passes() const { return passes_; }

 private:
  std::vector<Pass> passes_;
};

}  // namespace helio::render
