// Switches of light transport by the names that the wire, command lines and benchmarks share.
#pragma once

#include "render/renderer.h"

namespace helio::render {

struct LightSwitch {
  const char* name;  ///< of the field of ViewSettings, and of heliograph.v1.LightTransport
  bool ViewSettings::*field;
  const char* description;
};

inline constexpr LightSwitch kLightSwitches[] = {
    {"roulette", &ViewSettings::roulette, "end paths of little weight at random"},
    {"light_sampling", &ViewSettings::light_sampling, "sample lights at every vertex"},
    {"mis", &ViewSettings::mis, "weight light and scattering samples against each other"},
    {"sky_sampling", &ViewSettings::sky_sampling, "sample the sky as a light"},
    {"light_lists", &ViewSettings::light_lists, "choose lamps from the list of their cell"},
    {"light_feedback", &ViewSettings::light_feedback, "lists learn which lamps shadow rays find"},
    {"round_surfaces", &ViewSettings::round_surfaces, "rays leave from the surface that vertex normals tell of"},
    {"multiple_scattering", &ViewSettings::multiple_scattering, "keep what microfacets scatter more than once"},
};

}  // namespace helio::render
