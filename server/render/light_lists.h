// The light grid as shadow rays have taught it which lamps are seen from where (shaders/shared/light_lists.h). Made for
// the first view that asks for it; what was learned is forgotten when lamps come, go or move.
#pragma once

#include "render/emitter_instances.h"
#include "shared/light_lists.h"

namespace helio::render {

class LightLists {
 public:
  explicit LightLists(gpu::Device& device) : device_(device) {}

  /// Makes room for the grid of `emitters`, as it is uploaded by now. True: nothing has been learned of it yet.
  bool fit(gpu::Commands& commands, const EmitterInstances& emitters);
  /// What the pass that learns is told.
  shared::LightListConstants constants(const EmitterInstances& emitters, bool reset) const;
  /// Lets a view choose lamps from what was learned, and tell what its shadow rays find.
  void describe(shared::FrameConstants& constants) const;
  uint64_t bytes() const { return learned_.size() + memories_.size(); }
  /// After a tick that failed.
  void forget() { version_ = 0; }

 private:
  gpu::Device& device_;
  gpu::Buffer learned_, memories_;  // LightCell and LightMemory a cell
  uint64_t version_ = 0;            // of the tables that were learned about
};

}  // namespace helio::render
