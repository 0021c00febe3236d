#include "render/faults.h"

#include <array>

#include <spdlog/fmt/fmt.h>

namespace helio::render {
namespace {

constexpr std::array<const char*, shared::kFaultPasses> kPasses{"primary", "path_trace", "accumulate"};
constexpr std::array<const char*, shared::kFaultCauses> kCauses{"NaN", "infinite", "negative"};

const char* passOf(uint32_t kind) { return kPasses[kind / shared::kFaultCauses]; }
const char* causeOf(uint32_t kind) { return kCauses[kind % shared::kFaultCauses]; }

}  // namespace

void reportFaults(const shared::Faults& faults, uint32_t width, FrameStats& stats) {
  uint32_t first_place = 0;  // inverted: the largest comes first
  for (uint32_t kind = 0; kind < shared::kFaultKinds; ++kind) {
    if (faults.counts[kind] == 0) continue;
    stats.nonfinite += faults.counts[kind];
    stats.dropped.push_back({passOf(kind), causeOf(kind), faults.counts[kind]});
    if (faults.places[kind] <= first_place) continue;
    first_place = faults.places[kind];
    const uint32_t pixel = ~first_place >> shared::kFaultVertexBits;
    const uint32_t vertex = ~first_place & ((1u << shared::kFaultVertexBits) - 1u);
    stats.first_fault = {passOf(kind),         causeOf(kind), pixel % width, pixel / width,
                         ~faults.first_sample, vertex,        faults.seed};
  }
}

std::string describeFault(const FrameStats& stats, const ViewSettings& settings) {
  const FaultPlace& fault = *stats.first_fault;
  return fmt::format(
      "strict numerics: {} found a sample that is {} in tick {}: pixel ({}, {}) of {} x {}, sample {}, vertex {}, seed "
      "{}, {} mode with {} bounces; {} samples of this tick were dropped",
      fault.pass, fault.cause, stats.tick, fault.x, fault.y, settings.width, settings.height, fault.sample,
      fault.vertex, fault.seed, settings.mode == Mode::reference ? "reference" : "hybrid", settings.bounces,
      stats.nonfinite);
}

}  // namespace helio::render
