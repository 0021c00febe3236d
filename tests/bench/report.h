// What every benchmark's report has: where its figures come from, and tables.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "render/renderer.h"

namespace helio::bench {

/// Keys stay in the order in which they are written: passes come in the order of the frame.
using Json = nlohmann::ordered_json;

/// Figures mean nothing without it.
struct Provenance {
  render::DeviceInfo device;
  std::string command;  ///< the command line, quoted for a shell
  std::string date;     ///< of the start, UTC, ISO 8601
  std::string build;    ///< CMake's build type
};

/// Of a run that starts now.
Provenance provenance(render::DeviceInfo device, std::string command);

/// Adds `device`, `driver`, `command`, `date` and `build`.
void append(Json& report, const Provenance& provenance);
/// The same as a Markdown list.
std::string markdown(const Provenance& provenance);

/// The command line as one can paste it into a shell.
std::string shellCommand(int argc, const char* const* argv);

/// A Markdown table, aligned for reading as it is: first column to the left, the others to the right.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string markdown() const;

 private:
  std::vector<std::string> wellFormed(const std::vector<std::string>& row) const;

  std::vector<std::vector<std::string>> rows_;
};

/// With so many digits after the point.
std::string fixed(double value, int digits);
/// With three digits that say something, whatever the size.
std::string shown(double value);
/// As text of an HTML page.
std::string escaped(const std::string& text);
/// 1,234,567
std::string grouped(uint64_t value);
/// Bytes in MB (10^6).
std::string megabytes(uint64_t bytes);

}  // namespace helio::bench
