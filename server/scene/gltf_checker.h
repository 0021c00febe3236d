// The vocabulary in which a glTF document is checked: each function looks at one member of one JSON object.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "base/result.h"

namespace helio::scene {

/// Keeps the first thing that is wrong. Checks may go on after it, for they read nothing unchecked.
class GltfChecker {
 public:
  using json = nlohmann::json;
  static constexpr uint64_t kAny = uint64_t{1} << 53;  ///< beyond it JSON numbers are not exact

  explicit GltfChecker(const json& root) : root_(root) {}

  const std::optional<Error>& error() const { return error_; }
  const json& root() const { return root_; }

  void fail(ErrorKind kind, const std::string& field, std::string value, const std::string& why);
  void fail(const std::string& field, const json& value, const std::string& why);

  static std::string join(const std::string& at, const char* key) { return at.empty() ? key : at + "." + key; }
  static bool has(const json& object, const char* key) { return object.is_object() && object.contains(key); }
  /// null when there is none, and when `object` is no object.
  static const json& member(const json& object, const char* key);

  /// Calls check(entry, "list[i]", i) for the entries of a list of the document until something is wrong.
  template <typename Check>
  void each(const char* list, Check&& check) {
    const json& entries = member(root_, list);
    for (size_t i = 0; i < entries.size() && !error_; ++i) check(entries[i], fmt::format("{}[{}]", list, i), i);
  }
  /// A list of the document is absent or an array of objects.
  void listOfObjects(const json& owner, const std::string& at, const char* list);

  /// An integer in [low, high], or `fallback` when there is none.
  uint64_t integer(const json& object, const std::string& at, const char* key, std::optional<uint64_t> fallback,
                   uint64_t low, uint64_t high);
  /// A number in [low, high], or `fallback` when there is none.
  double number(const json& object, const std::string& at, const char* key, double fallback, double low, double high);
  /// Absent, or `count` numbers in [low, high], by default what floats can hold.
  void numbers(const json& object, const std::string& at, const char* key, size_t count, double low, double high);
  void numbers(const json& object, const std::string& at, const char* key, size_t count);

  /// Indices into a list of the document.
  void index(const json& value, const std::string& field, const char* list);
  void reference(const json& object, const std::string& at, const char* key, const char* list);
  void references(const json& object, const std::string& at, const char* key, const char* list);

  /// The member if it is an object; null when it is absent or wrong.
  const json& object(const json& owner, const std::string& at, const char* key);
  /// The object of an extension of `owner`, and its place; null when it is absent or wrong.
  const json& extension(const json& owner, const std::string& at, const char* name, std::string& place);

 private:
  const json& root_;
  std::optional<Error> error_;
};

}  // namespace helio::scene
