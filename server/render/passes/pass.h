// What every pass of a view is given.
#pragma once

#include "effects/registry.h"
#include "render/graph.h"
#include "render/path_queue.h"
#include "render/view.h"

namespace helio::render {

/// One view in one tick. `owner` names it in the graph; `tlas` stands for the acceleration structure there;
/// `paths` is working memory.
struct ViewPass {
  Graph& graph;
  View& view;
  int owner;
  Resource tlas;
  Resource instances;
  PathQueue& paths;
  Resource hits = nullptr;         ///< what rays count into; null: they do not
  bool any_hit_boxes = false;      ///< accel::BoxHits
  Resource light_lists = nullptr;  ///< what shadow rays teach; null: they do not
};

/// Groups of `size` x `size` pixels that cover the view.
inline void dispatchOver(gpu::Commands& commands, const View& view, uint32_t size) {
  commands.dispatch((view.settings().width + size - 1) / size, (view.settings().height + size - 1) / size);
}

}  // namespace helio::render
