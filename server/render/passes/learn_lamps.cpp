#include "render/passes/learn_lamps.h"

namespace helio::render {

void LearnLamps::dispatch(gpu::Commands& commands, const shared::LightListConstants& constants) const {
  if (constants.cells == 0) return;
  commands.bind(pipeline_);
  commands.push(constants);
  commands.dispatch((constants.cells + 63) / 64);
}

void LearnLamps::addAhead(Graph& graph, LightLists& lists, const EmitterInstances& emitters) const {
  graph.add("light_lists", Graph::kShared, {{&emitters, gpu::use::compute_read}, {&lists, gpu::use::compute_write}},
            [this, &lists, &emitters](gpu::Commands& commands) {
              if (lists.fit(commands, emitters)) dispatch(commands, lists.constants(emitters, true));
            });
}

void LearnLamps::add(Graph& graph, LightLists& lists, const EmitterInstances& emitters) const {
  graph.add(
      "learn_lamps", Graph::kShared, {{&emitters, gpu::use::compute_read}, {&lists, gpu::use::compute_write}},
      [this, &lists, &emitters](gpu::Commands& commands) { dispatch(commands, lists.constants(emitters, false)); });
}

}  // namespace helio::render
