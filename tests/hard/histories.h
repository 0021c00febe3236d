// Cases about what a view keeps from before, and about where things are.
#pragma once

#include "hard/cases.h"

namespace helio::test {

/// A still life `metres` from the origin along x and z, beside the same one at the origin.
HardScene stillLifeAt(double metres);

/// The view looked at a lamp of radiance 1000, then jumps `metres` away, to a plane that is 1000 times darker.
HardScene afterAJump(double metres);
/// The same with `factor` times as many pixels before.
HardScene afterAResize(double factor);

/// A plane under the sky in a world whose clock makes steps of `seconds`.
HardScene timeStep(double seconds);

}  // namespace helio::test
