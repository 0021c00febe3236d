#include "render/passes/asvgf.h"

#include "shared/filter.h"
#include "shared/gradients.h"

namespace helio::render {
namespace {

/// Groups of 8 x 8 strata that cover the view.
void dispatchOverStrata(gpu::Commands& commands, const View& view) {
  const gpu::Image& strata = view.histories.claims;
  commands.dispatch((strata.width() + 7) / 8, (strata.height() + 7) / 8);
}

}  // namespace

Asvgf::Asvgf(gpu::Device& device)
    : project_(device, "asvgf/project.comp"),
      gradient_(device, "asvgf/gradient.comp"),
      choose_(device, "asvgf/choose.comp"),
      atrous_(device, "asvgf/atrous.comp"),
      filter_(device, Feedback::integrated) {}

void Asvgf::addAhead(const ViewPass& pass) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  pass.graph.add("asvgf_project", pass.owner,
                 {{&view.visibility, gpu::use::compute_read},
                  {pass.instances, gpu::use::compute_read},
                  {&view.constants, gpu::use::compute_read},
                  {&h.gradient_samples, gpu::use::compute_read},
                  {&h.claims, gpu::use::compute_write}},
                 [this, &view](gpu::Commands& commands) {
                   shared::GradientConstants constants{};
                   constants.frame = view.constants.address();
                   commands.bind(project_);
                   commands.push(constants);
                   dispatchOverStrata(commands, view);
                 });
}

void Asvgf::addBetween(const ViewPass& pass, const shared::SampleConstants& sample) const {
  View& view = pass.view;
  const Histories& h = view.histories;
  pass.graph.add("asvgf_gradient", pass.owner,
                 {{&h.sampled, gpu::use::compute_read},
                  {&h.surface(), gpu::use::compute_read},
                  {&h.motion, gpu::use::compute_read},
                  {&view.visibility, gpu::use::compute_read},
                  {pass.instances, gpu::use::compute_read},
                  {&h.claims, gpu::use::compute_write},
                  {&h.gradient_samples, gpu::use::compute_write},
                  {&h.spare, gpu::use::compute_write},
                  {&h.changes, gpu::use::compute_write}},
                 [this, &view, sample](gpu::Commands& commands) {
                   shared::GradientConstants constants{};
                   constants.frame = view.constants.address();
                   constants.keeps = !view.accumulating();
                   constants.seed = sample.seed;
                   constants.jitter = sample.jitter;
                   const auto dispatch = [&](const gpu::ComputePipeline& pipeline) {
                     commands.bind(pipeline);
                     commands.push(constants);
                     dispatchOverStrata(commands, view);
                     commands.barrier(gpu::use::compute_write, gpu::use::compute_write);
                   };
                   dispatch(gradient_);
                   for (; constants.iteration < shared::kGradientIterations; ++constants.iteration) dispatch(atrous_);
                   dispatch(choose_);
                 });
}

void Asvgf::add(const ViewPass& pass, const shared::SampleConstants& sample,
                const shared::SampleConstants& last) const {
  filter_.add(pass, sample, last);
}

}  // namespace helio::render
