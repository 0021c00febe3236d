#include "render/graph.h"

#include <algorithm>
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

/// What one queue is given.
class Lane {
 public:
  Lane(gpu::Commands& commands, size_t passes) : commands_(commands) {
    // What the frame before left is visible to every pass of this one.
    commands.barrier(gpu::use::everything, gpu::use::everything);
    commands.reserveTimers(passes);
  }

  /// The pass touches what this lane wrote, or writes what it touched, since the other lane last waited for it.
  bool conflicts(const Graph::Pass& pass) const {
    return std::any_of(pass.accesses.begin(), pass.accesses.end(), [this](const Access& access) {
      const auto found = unseen_.find(access.resource);
      return found != unseen_.end() && (found->second || gpu::writes(access.use));
    });
  }
  bool hasUnseen() const { return !unseen_.empty(); }

  /// What comes from here on waits for all that `other` was given. A semaphore makes everything visible, so it takes no
  /// barriers.
  void waitFor(Lane& other) {
    const gpu::Point done = other.commands_.cut();
    other.unseen_.clear();
    commands_.cut();
    commands_.await(done);
  }

  void record(const Graph::Pass& pass) {
    // Each by itself: accesses of one use are not allowed at the stages of another.
    commands_.barrier(dependenciesOf(pass));
    commands_.beginTimer(pass.name);
    pass.record(commands_);
    commands_.endTimer();
  }

 private:
  std::vector<gpu::Dependency> dependenciesOf(const Graph::Pass& pass) {
    std::vector<gpu::Dependency> dependencies;
    for (const Access& access : pass.accesses) {
      unseen_[access.resource] |= gpu::writes(access.use);
      History& history = histories_[access.resource];
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
    return dependencies;
  }

  gpu::Commands& commands_;
  std::unordered_map<Resource, History> histories_;
  std::unordered_map<Resource, bool> unseen_;  // by the other lane: true where this one wrote
};

}  // namespace

void Graph::add(std::string name, int owner, std::vector<Access> accesses, std::function<void(gpu::Commands&)> record,
                gpu::Queue queue) {
  passes_.push_back({std::move(name), owner, std::move(accesses), std::move(record), queue});
}

void Graph::record(gpu::Commands& main, gpu::Commands* async) const {
  Lane first(main, passes_.size());
  if (!async) {
    for (const Pass& pass : passes_) first.record(pass);
    return;
  }
  Lane second(*async, passes_.size());
  for (const Pass& pass : passes_) {
    const bool aside = pass.queue == gpu::Queue::async;
    Lane &lane = aside ? second : first, &other = aside ? first : second;
    if (other.conflicts(pass)) lane.waitFor(other);
    lane.record(pass);
  }
  if (second.hasUnseen()) first.waitFor(second);
}

std::vector<gpu::TimedPass> Graph::finish(gpu::Commands& main, gpu::Commands* async) const {
  std::vector<gpu::TimedPass> first = main.finish();
  if (!async) return first;
  const std::vector<gpu::TimedPass> second = async->finish();
  std::vector<gpu::TimedPass> times;
  auto on_main = first.begin();
  auto on_async = second.begin();
  for (const Pass& pass : passes_) times.push_back(pass.queue == gpu::Queue::async ? *on_async++ : *on_main++);
  return times;
}

}  // namespace helio::render
