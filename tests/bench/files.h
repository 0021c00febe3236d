// Results as files.
#pragma once

#include <fstream>
#include <string>

#include "base/result.h"

namespace helio::bench {

/// Errors (invalid): the file cannot be written.
inline Result<void> writeFile(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  if (!file.flush())
    return invalid("--out", path, "cannot write " + path + ": give a place that exists and can be written to");
  return {};
}

}  // namespace helio::bench
