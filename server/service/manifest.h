// What a world is made of, as its log keeps it: by name and digest, never by a path of this machine.
#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "base/result.h"
#include "scene/city.h"
#include "scene/scene.h"

namespace helio::service {

struct Manifest {
  /// A file below the server's glTF folder.
  struct Gltf {
    std::string path;
  };
  std::variant<scene::CityParameters, Gltf> source;
  /// Of the scene that came of it, "sha256:" and 64 hexadecimal digits; empty until it was loaded for the first time.
  std::string digest;

  std::string description() const;  ///< "city seed 1, 10000 instances"
  bool sameSource(const Manifest& other) const;
};

/// JSON, for people who look into a log. decode() errors: damaged, a newer format (unsupported).
std::string encode(const Manifest& manifest);
Result<Manifest> decodeManifest(const std::string& bytes);

/// What edits depend on: prefabs by name and index, base instances by number. Of a file also every vertex and
/// transform; of a generated city not, for they depend, in their last digits, on the C library's sine.
std::string digestOf(const scene::Scene& scene, const Manifest& manifest);

}  // namespace helio::service
