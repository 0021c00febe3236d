// A YAML mapping that is read strictly: what is missing, out of range or unknown is named with its line.
#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace helio::load {

/// Thrown while a scenario is read; parseScenario() makes an Error of it.
struct Wrong {
  int line;  ///< from 1; 0: nowhere in particular
  std::string message;
};

/// "line 7: ..." is all that a reader needs to find the place.
[[noreturn]] void refuse(const YAML::Node& node, const std::string& message);

class YamlMap {
 public:
  /// `what` is what messages call it: "group builders". Refuses what is no mapping, and keys that occur twice.
  YamlMap(const YAML::Node& node, std::string what);

  /// The value of a key, or nothing; the key counts as known from now on.
  std::optional<YAML::Node> find(const std::string& key);
  YAML::Node need(const std::string& key);

  std::string text(const std::string& key);
  std::string text(const std::string& key, const std::string& otherwise);
  std::string oneOf(const std::string& key, std::initializer_list<const char*> names, const std::string& otherwise);
  double number(const std::string& key, double low, double high);
  double number(const std::string& key, double low, double high, double otherwise);
  uint64_t whole(const std::string& key, uint64_t low, uint64_t high, uint64_t otherwise);
  bool flag(const std::string& key, bool otherwise);

  /// Refuses the first key that nobody asked for.
  void finish() const;

  const YAML::Node& node() const { return node_; }

 private:
  YAML::Node node_;
  std::string what_;
  std::vector<std::string> known_;
};

std::string textOf(const YAML::Node& node, const std::string& what);
double numberOf(const YAML::Node& node, const std::string& what, double low, double high);
uint64_t wholeOf(const YAML::Node& node, const std::string& what, uint64_t low, uint64_t high);

}  // namespace helio::load
