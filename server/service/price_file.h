// A price list of the operator's own: what `helio-bench accuracy --axis preset` measured on this machine.
#pragma once

#include <filesystem>

#include "base/result.h"
#include "render/ladder.h"

namespace helio::service {

/// Reads accuracy.json (schema heliograph.bench.accuracy/1), which must have a point for every rung of the ladder.
/// Errors: no such file (not_found); no such document, a rung without a point, a price that is not above 0 (invalid):
/// each names the file.
Result<render::PriceList> readPriceList(const std::filesystem::path& file);

}  // namespace helio::service
