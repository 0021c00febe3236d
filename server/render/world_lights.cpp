// How a world's light is followed for a view: technique, lens, and what lamps are known by.
#include "render/world_renderer.h"

namespace helio::render {

bool WorldRenderer::learnsLamps(const ViewSettings& settings) const {
  const bool lamps =
      effects_.has(effects::Effect::emissive_triangles) || effects_.has(effects::Effect::punctual_lights);
  return lamps && settings.light_feedback && settings.mode == Mode::hybrid && !showsProperty(settings.materials);
}

void WorldRenderer::describeTechnique(shared::FrameConstants& constants, View& view) const {
  const ViewSettings& settings = view.settings();
  constants.lens_radius = 0.5f * settings.aperture;
  constants.focus = settings.focus;
  constants.ambient_radius = settings.ambient_radius;
  constants.lamp_shapes = resources_.lampShapes();
  if (learnsLamps(settings)) light_lists_.describe(constants);
  if (view.histories.indirect) constants.indirect = view.histories.indirect.address();
}

}  // namespace helio::render
