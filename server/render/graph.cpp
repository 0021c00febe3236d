#include "render/graph.h"

#include <unordered_map>

namespace helio::render {
namespace {

/// What happened to a resource since it was last written.
struct History {
  gpu::Use write;  ///< the last writer
  gpu::Use reads;  ///< all readers since
};

void operator|=(gpu::Use& a, const gpu::Use& b) {
  a.stages |= b.stages;
  a.access |= b.access;
}

}  // namespace

void Graph::add(std::string name, int owner, std::vector<Access> accesses, std::function<void(gpu::Commands&)> record) {
  passes_.push_back({std::move(name), owner, std::move(accesses), std::move(record)});
}

void Graph::record(gpu::Commands& commands) const {
  // What the frame before left is visible to every pass of this one.
  commands.barrier(gpu::use::everything, gpu::use::everything);
  commands.reserveTimers(passes_.size());
  std::unordered_map<Resource, History> histories;
  for (const Pass& pass : passes_) {
    std::vector<gpu::Dependency> dependencies;
    for (const Access& access : pass.accesses) {
      History& history = histories[access.resource];
      if (history.write.stages) {  // read after write, write after write
        dependencies.push_back({history.write, access.use});
      }
      if (gpu::writes(access.use)) {
        if (history.reads.stages) {  // write after read: order is enough, there is nothing to make visible
          dependencies.push_back({{history.reads.stages, 0}, {access.use.stages, 0}});
        }
        history = {access.use, {}};
      } else {
        history.reads |= access.use;
      }
    }
    // Each by itself: accesses of one use are not allowed at the stages of another.
    commands.barrier(dependencies);
    commands.beginTimer(pass.name);
    pass.record(commands);
    commands.endTimer();
  }
}

}  // namespace helio::render
