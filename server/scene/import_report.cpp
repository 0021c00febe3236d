#include "scene/import_report.h"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace helio::scene {
void ImportReport::ignore(const std::string& what, const std::string& why, uint64_t count) {
  const auto known = std::find_if(ignored.begin(), ignored.end(), [&](const Ignored& i) { return i.what == what; });
  if (known == ignored.end()) {
    ignored.push_back({what, why, count});
  } else {
    known->count += count;
  }
}

std::string summary(const ImportReport& report) {
  const auto plural = [](uint64_t count, const char* one, const char* many) {
    return fmt::format("{} {}", count, count == 1 ? one : many);
  };
  return fmt::format("{} ({}, {}), {}, {}, {}, {}, {}; extensions: {}", plural(report.meshes, "mesh", "meshes"),
                     plural(report.primitives, "primitive", "primitives"),
                     plural(report.triangles, "triangle", "triangles"),
                     plural(report.materials, "material", "materials"), plural(report.textures, "texture", "textures"),
                     plural(report.instances, "instance", "instances"), plural(report.lights, "light", "lights"),
                     plural(report.cameras, "camera", "cameras"),
                     report.extensions.empty() ? "none" : fmt::format("{}", fmt::join(report.extensions, ", ")));
}

std::string line(const ImportReport::Ignored& ignored) {
  const std::string times = ignored.count == 1 ? "" : fmt::format(" ({} times)", ignored.count);
  return fmt::format("{}{} ignored: {}", ignored.what, times, ignored.why);
}

}  // namespace helio::scene
