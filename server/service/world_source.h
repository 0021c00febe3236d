// Where worlds come from: the requests' sources, checked before anything is loaded.
#pragma once

#include <heliograph/v1/world.pb.h>

#include <filesystem>
#include <functional>

#include "service/failure.h"
#include "service/limits.h"
#include "service/manifest.h"

namespace helio::service {

/// How a world's base scene comes to be.
struct WorldSource {
  Manifest manifest;
  std::function<Result<scene::ScenePtr>()> load;  ///< takes its time; called once, on the world's own thread

  std::string description() const { return manifest.description(); }
};

/// Failures: of a city, `instances` out of range; of a file, whose path is relative to `gltf_root` and may not leave
/// it, not through links either: no root, outside, no such file.
Outcome<WorldSource> sourceOf(Manifest manifest, const std::filesystem::path& gltf_root, const Limits& limits);

Outcome<WorldSource> sourceOf(const v1::CreateWorldRequest& request, const std::filesystem::path& gltf_root,
                              const Limits& limits);

}  // namespace helio::service
