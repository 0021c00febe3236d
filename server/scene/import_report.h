// What an import read, and what it left out and why.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace helio::scene {

struct ImportReport {
  std::string file;
  uint64_t meshes = 0;  ///< with triangles
  uint64_t primitives = 0;
  uint64_t triangles = 0;  ///< of all meshes, each counted once
  uint64_t materials = 0;
  uint64_t textures = 0;
  uint64_t instances = 0;               ///< placements
  uint64_t lights = 0;                  ///< punctual ones, placed
  uint64_t cameras = 0;                 ///< of the file
  std::vector<std::string> extensions;  ///< that the file says it uses

  /// Something of the file that the scene does not show, and why.
  struct Ignored {
    std::string what;
    std::string why;
    uint64_t count = 1;  ///< how often
  };
  std::vector<Ignored> ignored;

  /// Counts `what` among the ignored; the first reason given for it stands.
  void ignore(const std::string& what, const std::string& why, uint64_t count = 1);
};

/// The counts in one line: "3 meshes (4 primitives, 120 triangles), 2 materials, ...; extensions: ...".
std::string summary(const ImportReport& report);

/// One line of an ignored thing: "alpha modes (3 times) ignored: every surface is opaque".
std::string line(const ImportReport::Ignored& ignored);

}  // namespace helio::scene
