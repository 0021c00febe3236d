// Passes `light_lists` and `learn_lamps`: ahead of a tick's views the lists of lamps are made fit, behind them they
// learn what shadow rays have found.
#pragma once

#include "gpu/pipelines.h"
#include "render/graph.h"
#include "render/light_lists.h"

namespace helio::render {

class LearnLamps {
 public:
  explicit LearnLamps(gpu::Device& device) : pipeline_(device, "light_lists/learn.comp") {}
  void addAhead(Graph& graph, LightLists& lists, const EmitterInstances& emitters) const;
  void add(Graph& graph, LightLists& lists, const EmitterInstances& emitters) const;

 private:
  void dispatch(gpu::Commands& commands, const shared::LightListConstants& constants) const;

  gpu::ComputePipeline pipeline_;
};

}  // namespace helio::render
