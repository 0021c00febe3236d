// The log's bytes of a batch. Little-endian, no padding, one encoding for each batch:
//
//   u8 version (1), u32 edits, then for every edit: u8 kind and
//     1 build        u32 prefab, u64 first id, u32 poses, poses
//     2 destroy      u32 ids, u64 each
//     3 move         u64 id, pose
//     4 environment  sun (direction, irradiance, angular diameter), sky (zenith, ground)
//   pose: f32 position x y z, rotation x y z w, scale
#include <bit>
#include <cstring>
#include <type_traits>

#include <spdlog/fmt/fmt.h>

#include "world/world.h"

namespace helio::world {
namespace {

constexpr uint8_t kVersion = 1;
enum class Kind : uint8_t { build = 1, destroy = 2, move = 3, environment = 4 };
static_assert(std::variant_size_v<ResolvedEdit> == 4, "a new kind of edit needs its own number here");

constexpr size_t kPoseBytes = 8 * sizeof(float);
constexpr size_t kSmallestEditBytes = sizeof(Kind) + sizeof(uint32_t);  // a destroy of nothing

class Writer {
 public:
  template <typename Integer>
  void integer(Integer value) {
    static_assert(std::is_unsigned_v<Integer>);
    for (size_t i = 0; i < sizeof value; ++i) bytes_.push_back(static_cast<char>(value >> (8 * i) & 0xff));
  }
  void kind(Kind value) { integer(static_cast<uint8_t>(value)); }
  void real(float value) { integer(std::bit_cast<uint32_t>(value)); }
  void vector(const glm::vec3& v) {
    for (int i = 0; i < 3; ++i) real(v[i]);
  }
  void pose(const Pose& pose) {
    vector(pose.position);
    for (float component : {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w}) real(component);
    real(pose.scale);
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

void write(Writer& out, const ResolvedBuild& build) {
  out.kind(Kind::build);
  out.integer(build.prefab);
  out.integer(build.first_id);
  out.integer(static_cast<uint32_t>(build.poses.size()));
  out.reserve(build.poses.size() * kPoseBytes);
  for (const Pose& pose : build.poses) out.pose(pose);
}

void write(Writer& out, const ResolvedDestroy& destroy) {
  out.kind(Kind::destroy);
  out.integer(static_cast<uint32_t>(destroy.ids.size()));
  out.reserve(destroy.ids.size() * sizeof(InstanceId));
  for (InstanceId id : destroy.ids) out.integer(id);
}

void write(Writer& out, const ResolvedMove& move) {
  out.kind(Kind::move);
  out.integer(move.id);
  out.pose(move.pose);
}

void write(Writer& out, const ResolvedEnvironment& change) {
  const auto& [sun, sky] = change.environment;
  out.kind(Kind::environment);
  out.vector(sun.direction);
  out.vector(sun.irradiance);
  out.real(sun.angular_diameter);
  out.vector(sky.zenith);
  out.vector(sky.ground);
}

ResolvedBuild readBuild(Reader& in) {
  ResolvedBuild build;
  build.prefab = in.integer<uint32_t>();
  build.first_id = in.integer<InstanceId>();
  build.poses.resize(in.count(kPoseBytes));
  for (Pose& pose : build.poses) pose = in.pose();
  return build;
}

ResolvedDestroy readDestroy(Reader& in) {
  ResolvedDestroy destroy;
  destroy.ids.resize(in.count(sizeof(InstanceId)));
  for (InstanceId& id : destroy.ids) id = in.integer<InstanceId>();
  return destroy;
}

ResolvedMove readMove(Reader& in) {
  ResolvedMove move;
  move.id = in.integer<InstanceId>();
  move.pose = in.pose();
  return move;
}

ResolvedEnvironment readEnvironment(Reader& in) {
  ResolvedEnvironment change;
  auto& [sun, sky] = change.environment;
  sun.direction = in.vector();
  sun.irradiance = in.vector();
  sun.angular_diameter = in.real();
  sky.zenith = in.vector();
  sky.ground = in.vector();
  return change;
}

Error malformed(size_t position, std::string value, const std::string& why) {
  return invalid("batch", std::move(value),
                 fmt::format("batch: {} at byte {}, the log is damaged or newer than this server", why, position));
}

}  // namespace

std::string encode(const Batch& batch) {
  Writer out;
  out.integer(kVersion);
  out.integer(static_cast<uint32_t>(batch.edits.size()));
  for (const ResolvedEdit& edit : batch.edits) {
    std::visit([&out](const auto& resolved) { write(out, resolved); }, edit);
  }
  return out.take();
}

Result<Batch> decode(std::span<const std::byte> bytes) {
  Reader in(bytes);
  const uint8_t version = in.integer<uint8_t>();
  if (in.failed()) return malformed(0, "0 bytes", "nothing there");
  if (version != kVersion) {
    return malformed(0, fmt::format("{}", version), fmt::format("version {} instead of {}", version, kVersion));
  }
  const uint32_t edits = in.count(kSmallestEditBytes);

  Batch batch;
  batch.edits.reserve(edits);
  for (uint32_t i = 0; i < edits && !in.failed(); ++i) {
    const size_t start = in.position();
    const uint8_t kind = in.integer<uint8_t>();
    switch (static_cast<Kind>(kind)) {
      case Kind::build:
        batch.edits.push_back(readBuild(in));
        break;
      case Kind::destroy:
        batch.edits.push_back(readDestroy(in));
        break;
      case Kind::move:
        batch.edits.push_back(readMove(in));
        break;
      case Kind::environment:
        batch.edits.push_back(readEnvironment(in));
        break;
      default:
        return malformed(start, fmt::format("{}", kind), fmt::format("edit of unknown kind {}", kind));
    }
  }
  if (in.failed()) return malformed(bytes.size(), fmt::format("{} bytes", bytes.size()), "truncated");
  if (in.remaining() != 0) {
    return malformed(in.position(), fmt::format("{} bytes", in.remaining()),
                     fmt::format("{} bytes too many", in.remaining()));
  }
  return batch;
}

}  // namespace helio::world
