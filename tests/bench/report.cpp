#include "bench/report.h"

#include <algorithm>
#include <cstdio>
#include <ctime>

namespace helio::bench {
namespace {

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[sizeof "2000-01-01T00:00:00Z"];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

std::string quoted(const std::string& argument) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
  if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos) return argument;
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

Provenance provenance(render::DeviceInfo device, std::string command) {
  return {std::move(device), std::move(command), utcNow(), HELIOGRAPH_BUILD_TYPE};
}

void append(Json& report, const Provenance& provenance) {
  report["device"] = provenance.device.name;
  report["driver"] = provenance.device.driver;
  report["command"] = provenance.command;
  report["date"] = provenance.date;
  report["build"] = provenance.build;
}

std::string markdown(const Provenance& provenance) {
  return "- command: `" + provenance.command + "`\n" +  //
         "- device: " + provenance.device.name + ", " + provenance.device.driver + "\n" + "- date: " + provenance.date +
         "\n" +  //
         "- build: " + provenance.build + "\n";
}

std::string shellCommand(int argc, const char* const* argv) {
  std::string command;
  for (int i = 0; i < argc; ++i) command += (i == 0 ? "" : " ") + quoted(argv[i]);
  return command;
}

std::vector<std::string> Table::wellFormed(const std::vector<std::string>& row) const {
  std::vector<std::string> cells;
  for (const std::string& cell : row) {
    std::string text;
    for (const char c : cell) text += c == '|' ? std::string("\\|") : std::string(1, c);
    cells.push_back(std::move(text));
  }
  cells.resize(rows_.front().size());
  return cells;
}

std::string Table::markdown() const {
  std::vector<std::vector<std::string>> rows;
  for (const auto& row : rows_) rows.push_back(wellFormed(row));
  std::vector<size_t> widths(rows.front().size(), 3);
  for (const auto& row : rows)
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());

  std::string text;
  const auto line = [&](const std::vector<std::string>& row) {
    for (size_t i = 0; i < row.size(); ++i) {
      const std::string padding(widths[i] - row[i].size(), ' ');
      text += "| " + (i == 0 ? row[i] + padding : padding + row[i]) + " ";
    }
    text += "|\n";
  };
  line(rows.front());
  for (size_t i = 0; i < widths.size(); ++i)
    text += i == 0 ? "| " + std::string(widths[i], '-') + " " : "| " + std::string(widths[i] - 1, '-') + ": ";
  text += "|\n";
  std::for_each(rows.begin() + 1, rows.end(), line);
  return text;
}

std::string fixed(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::string shown(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

std::string grouped(uint64_t value) {
  std::string text = std::to_string(value);
  for (size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, ",");
  return text;
}

std::string megabytes(uint64_t bytes) { return fixed(static_cast<double>(bytes) / 1e6, 1); }

}  // namespace helio::bench
