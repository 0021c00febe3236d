// heliographd doctor: can this machine serve, and if not, what mends it.
#pragma once

#include <string>
#include <vector>

#include "daemon/configuration.h"

namespace helio::daemon {

struct Finding {
  enum class Grade { good, warning, bad };
  std::string check;  ///< "device", "memory", "port", "ops port", "log folder", "keys"
  Grade grade = Grade::good;
  std::string found;  ///< one line
  std::string mend;   ///< what to do; empty: nothing
};

/// Looks at what `configuration` would use. It changes nothing, but makes the log folder if it is not there.
std::vector<Finding> examine(const Configuration& configuration);

/// One line a finding, or one JSON document. Nothing bad: the machine can serve.
std::string report(const std::vector<Finding>& findings, bool json);
bool canServe(const std::vector<Finding>& findings);

}  // namespace helio::daemon
