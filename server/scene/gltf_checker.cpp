#include "scene/gltf_checker.h"

#include <cmath>
#include <limits>

namespace helio::scene {
namespace {

const nlohmann::json kNothing;
constexpr double kMost = std::numeric_limits<float>::max();

}  // namespace

void GltfChecker::fail(ErrorKind kind, const std::string& field, std::string value, const std::string& why) {
  if (error_) return;
  if (value.size() > 60) value = value.substr(0, 57) + "...";
  error_ = Error{kind, fmt::format("{} is {}: {}", field, value, why), field, value, {}};
}

void GltfChecker::fail(const std::string& field, const json& value, const std::string& why) {
  // A document from a stranger may hold anything, also text that is not UTF-8.
  fail(ErrorKind::invalid, field,
       &value == &kNothing ? "missing" : value.dump(-1, ' ', false, json::error_handler_t::replace), why);
}

const GltfChecker::json& GltfChecker::member(const json& object, const char* key) {
  if (!object.is_object()) return kNothing;
  const auto found = object.find(key);
  return found == object.end() ? kNothing : *found;
}

void GltfChecker::listOfObjects(const json& owner, const std::string& at, const char* list) {
  const json& entries = member(owner, list);
  if (entries.is_null()) return;
  const std::string field = join(at, list);
  if (!entries.is_array()) return fail(field, entries, "it must be an array");
  for (size_t i = 0; i < entries.size() && !error_; ++i) {
    if (!entries[i].is_object()) fail(fmt::format("{}[{}]", field, i), entries[i], "it must be an object");
  }
}

uint64_t GltfChecker::integer(const json& object, const std::string& at, const char* key,
                              std::optional<uint64_t> fallback, uint64_t low, uint64_t high) {
  const json& value = member(object, key);
  if (fallback && !has(object, key)) return *fallback;
  if (!value.is_number_unsigned() || value.get<uint64_t>() < low || value.get<uint64_t>() > high) {
    fail(join(at, key), value,
         high == kAny ? fmt::format("it must be an integer, {} or more", low)
                      : fmt::format("it must be an integer in [{}, {}]", low, high));
    return low;
  }
  return value.get<uint64_t>();
}

double GltfChecker::number(const json& object, const std::string& at, const char* key, double fallback, double low,
                           double high) {
  const json& value = member(object, key);
  if (!has(object, key)) return fallback;
  if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high)) {
    fail(join(at, key), value,
         high >= kMost ? (low <= -kMost ? "it must be a finite number"
                                        : fmt::format("it must be a finite number, {} or more", low))
                       : fmt::format("it must be a number in [{}, {}]", low, high));
    return fallback;
  }
  return value.get<double>();
}

void GltfChecker::numbers(const json& object, const std::string& at, const char* key, size_t count, double low,
                          double high) {
  if (!has(object, key)) return;
  const json& values = member(object, key);
  bool good = values.is_array() && values.size() == count;
  for (size_t i = 0; good && i < count; ++i) {
    good = values[i].is_number() && values[i].get<double>() >= low && values[i].get<double>() <= high;
  }
  if (good) return;
  fail(join(at, key), values,
       low <= -kMost   ? fmt::format("it must be {} finite numbers", count)
       : high >= kMost ? fmt::format("it must be {} finite numbers, {} or more", count, low)
                       : fmt::format("it must be {} numbers in [{}, {}]", count, low, high));
}

void GltfChecker::numbers(const json& object, const std::string& at, const char* key, size_t count) {
  numbers(object, at, key, count, -kMost, kMost);
}

void GltfChecker::index(const json& value, const std::string& field, const char* list) {
  const size_t size = member(root_, list).size();
  if (value.is_number_unsigned() && value.get<uint64_t>() < size) return;
  fail(field, value, fmt::format("it must be the index of one of {} {}", size, list));
}

void GltfChecker::reference(const json& object, const std::string& at, const char* key, const char* list) {
  const json& value = member(object, key);
  if (!value.is_null()) index(value, join(at, key), list);
}

void GltfChecker::references(const json& object, const std::string& at, const char* key, const char* list) {
  const json& values = member(object, key);
  if (values.is_null()) return;
  if (!values.is_array()) return fail(join(at, key), values, "it must be an array of indices");
  const size_t size = member(root_, list).size();
  for (size_t i = 0; i < values.size() && !error_; ++i) {
    if (values[i].is_number_unsigned() && values[i].get<uint64_t>() < size) continue;
    index(values[i], fmt::format("{}[{}]", join(at, key), i), list);
  }
}

const GltfChecker::json& GltfChecker::object(const json& owner, const std::string& at, const char* key) {
  const json& value = member(owner, key);
  if (value.is_object() || !has(owner, key)) return value;
  fail(join(at, key), value, "it must be an object");
  return kNothing;
}

const GltfChecker::json& GltfChecker::extension(const json& owner, const std::string& at, const char* name,
                                                std::string& place) {
  place = join(at, "extensions");
  const json& found = object(object(owner, at, "extensions"), place, name);
  place += std::string(".") + name;
  return found;
}

}  // namespace helio::scene
