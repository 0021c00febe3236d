#include "load/yaml_map.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <utility>

namespace helio::load {
namespace {

std::string shortOf(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12g", value);
  return text;
}

}  // namespace

void refuse(const YAML::Node& node, const std::string& message) { throw Wrong{node.Mark().line + 1, message}; }

std::string textOf(const YAML::Node& node, const std::string& what) {
  if (!node.IsScalar() || node.Scalar().empty()) refuse(node, what + " must be a word");
  return node.Scalar();
}

double numberOf(const YAML::Node& node, const std::string& what, double low, double high) {
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value))
    refuse(node, what + " must be a number");
  if (value < low || value > high)
    refuse(node, what + " is " + node.Scalar() + "; it may be " + shortOf(low) + " to " + shortOf(high));
  return value;
}

uint64_t wholeOf(const YAML::Node& node, const std::string& what, uint64_t low, uint64_t high) {
  uint64_t value = 0;
  const std::string text = node.IsScalar() ? node.Scalar() : std::string();
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size())
    refuse(node, what + " must be a whole number");
  if (value < low || value > high)
    refuse(node, what + " is " + text + "; it may be " + std::to_string(low) + " to " + std::to_string(high));
  return value;
}

YamlMap::YamlMap(const YAML::Node& node, std::string what) : node_(node), what_(std::move(what)) {
  if (!node.IsMap()) refuse(node, what_ + " must be a mapping of keys to values");
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string key = textOf(entry.first, "a key of " + what_);
    if (!seen.insert(key).second) refuse(entry.first, "\"" + key + "\" occurs twice in " + what_);
  }
}

std::optional<YAML::Node> YamlMap::find(const std::string& key) {
  known_.push_back(key);
  const YAML::Node value = std::as_const(node_)[key];
  if (!value.IsDefined()) return std::nullopt;
  return value;
}

YAML::Node YamlMap::need(const std::string& key) {
  const auto value = find(key);
  if (!value) refuse(node_, what_ + " has no \"" + key + "\"");
  return *value;
}

std::string YamlMap::text(const std::string& key) { return textOf(need(key), "\"" + key + "\""); }

std::string YamlMap::text(const std::string& key, const std::string& otherwise) {
  const auto value = find(key);
  return value ? textOf(*value, "\"" + key + "\"") : otherwise;
}

std::string YamlMap::oneOf(const std::string& key, std::initializer_list<const char*> names,
                           const std::string& otherwise) {
  const auto value = find(key);
  if (!value) return otherwise;
  const std::string text = textOf(*value, "\"" + key + "\"");
  std::string list;
  for (const char* name : names) {
    if (text == name) return text;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  refuse(*value, "\"" + key + "\" is \"" + text + "\"; it may be " + list);
}

double YamlMap::number(const std::string& key, double low, double high) {
  return numberOf(need(key), "\"" + key + "\"", low, high);
}

double YamlMap::number(const std::string& key, double low, double high, double otherwise) {
  const auto value = find(key);
  return value ? numberOf(*value, "\"" + key + "\"", low, high) : otherwise;
}

uint64_t YamlMap::whole(const std::string& key, uint64_t low, uint64_t high, uint64_t otherwise) {
  const auto value = find(key);
  return value ? wholeOf(*value, "\"" + key + "\"", low, high) : otherwise;
}

bool YamlMap::flag(const std::string& key, bool otherwise) {
  const auto value = find(key);
  if (!value) return otherwise;
  bool flag = false;
  if (!value->IsScalar() || !YAML::convert<bool>::decode(*value, flag))
    refuse(*value, "\"" + key + "\" must be true or false");
  return flag;
}

void YamlMap::finish() const {
  for (const auto& entry : node_) {
    const auto& key = entry.first.Scalar();
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    std::string list;
    for (const auto& known : known_) list += (list.empty() ? "" : ", ") + known;
    refuse(entry.first, "unknown key \"" + key + "\" in " + what_ + "; it may have " + list);
  }
}

}  // namespace helio::load
