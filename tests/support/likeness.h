// How like each other two pictures look.
#pragma once

#include "render/renderer.h"

namespace helio::test {

/// Mean structural similarity of the luma of two pictures of one size, over all windows of 8 x 8 pixels
/// [Wang et al. 2004, with uniform windows]. 1: equal.
double structuralSimilarity(const render::Pixels& a, const render::Pixels& b);

}  // namespace helio::test
