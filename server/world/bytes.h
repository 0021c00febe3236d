// Little-endian bytes, written and read: what codec.cpp and snapshot.cpp share.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "world/world.h"

namespace helio::world {

constexpr size_t kPoseBytes = 8 * sizeof(float);
constexpr size_t kTransformBytes = 12 * sizeof(float);

class Writer {
 public:
  template <typename Integer>
  void integer(Integer value) {
    static_assert(std::is_unsigned_v<Integer>);
    for (size_t i = 0; i < sizeof value; ++i) bytes_.push_back(static_cast<char>(value >> (8 * i) & 0xff));
  }
  void real(float value) { integer(std::bit_cast<uint32_t>(value)); }
  void real(double value) { integer(std::bit_cast<uint64_t>(value)); }
  void vector(const glm::vec3& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  }
  void pose(const Pose& pose) {
    vector(pose.position);
    for (float component : {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w}) real(component);
    real(pose.scale);
  }
  void transform(const glm::mat4x3& m) {
    for (int column = 0; column < 4; ++column) vector(m[column]);
  }
  void environment(const scene::Environment& e) {
    vector(e.sun.direction);
    vector(e.sun.irradiance);
    real(e.sun.angular_diameter);
    vector(e.sky.zenith);
    vector(e.sky.ground);
  }
  void clock(const Clock& c) {
    real(c.time);
    real(c.rate);
    integer(uint8_t{c.paused});
  }
  void reserve(size_t more) { bytes_.reserve(bytes_.size() + more); }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads past the end give zeros and set failed(): one check after a group of reads is enough.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <typename Integer>
  Integer integer() {
    static_assert(std::is_unsigned_v<Integer>);
    if (remaining() < sizeof(Integer)) {
      failed_ = true;
      position_ = bytes_.size();
      return 0;
    }
    Integer value = 0;
    for (size_t i = 0; i < sizeof value; ++i)
      value |= static_cast<Integer>(std::to_integer<Integer>(bytes_[position_ + i]) << (8 * i));
    position_ += sizeof value;
    return value;
  }
  float real() { return std::bit_cast<float>(integer<uint32_t>()); }
  double realDouble() { return std::bit_cast<double>(integer<uint64_t>()); }
  glm::vec3 vector() {
    glm::vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = real();
    return v;
  }
  Pose pose() {
    Pose pose;
    pose.position = vector();
    pose.rotation.x = real();
    pose.rotation.y = real();
    pose.rotation.z = real();
    pose.rotation.w = real();
    pose.scale = real();
    return pose;
  }
  glm::mat4x3 transform() {
    glm::mat4x3 m;
    for (int column = 0; column < 4; ++column) m[column] = vector();
    return m;
  }
  scene::Environment environment() {
    scene::Environment e;
    e.sun.direction = vector();
    e.sun.irradiance = vector();
    e.sun.angular_diameter = real();
    e.sky.zenith = vector();
    e.sky.ground = vector();
    return e;
  }
  /// A pause that is neither 0 nor 1 fails.
  Clock clock() {
    Clock c;
    c.time = realDouble();
    c.rate = realDouble();
    const auto paused = integer<uint8_t>();
    failed_ |= paused > 1;
    c.paused = paused == 1;
    return c;
  }
  /// A count of entries of at least `entry_bytes` each. One that the rest of the input cannot hold fails.
  uint32_t count(size_t entry_bytes) {
    const uint32_t entries = integer<uint32_t>();
    if (entries <= remaining() / entry_bytes) return entries;
    failed_ = true;
    return 0;
  }

  bool failed() const { return failed_; }
  size_t position() const { return position_; }
  size_t remaining() const { return bytes_.size() - position_; }

 private:
  std::span<const std::byte> bytes_;
  size_t position_ = 0;
  bool failed_ = false;
};

}  // namespace helio::world
