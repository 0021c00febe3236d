// Where worlds come from: the requests' sources, checked before anything is loaded.
#pragma once

#include <heliograph/v1/world.pb.h>

#include <filesystem>

#include "scene/city.h"
#include "service/hosted_world.h"
#include "service/limits.h"

namespace helio::service {

/// Failures: `instances` out of range.
Outcome<WorldSource> citySource(const scene::CityParameters& parameters, const Limits& limits);

/// `path` is relative to `root` and may not leave it, not through links either. Failures: no root, outside, no such
/// file.
Outcome<WorldSource> gltfSource(const std::filesystem::path& root, const std::string& path);

Outcome<WorldSource> sourceOf(const v1::CreateWorldRequest& request, const std::filesystem::path& gltf_root,
                              const Limits& limits);

}  // namespace helio::service
