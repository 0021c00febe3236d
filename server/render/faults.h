// What the GPU counted as no light, in words.
#pragma once

#include "render/renderer.h"
#include "shared/faults.h"

namespace helio::render {

/// Fills in nonfinite, dropped and first_fault. `width`: of the picture.
void reportFaults(const shared::Faults& faults, uint32_t width, FrameStats& stats);

/// One line: what the first dropped sample was, and where. `stats` has a first_fault.
std::string describeFault(const FrameStats& stats, const ViewSettings& settings);

}  // namespace helio::render
