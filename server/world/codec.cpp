// The log's bytes of a batch. Little-endian, no padding, one encoding for each batch:
//
//   u8 version, u64 tick, f64 time, u32 edits, then for every edit: u8 kind and
//     1 build        u32 prefab, u64 first id, u32 poses, poses
//     2 destroy      u32 ids, u64 each
//     3 move         u64 id, pose
//     4 environment  sun (direction, irradiance, angular diameter), sky (zenith, ground)
//     5 time         f64 time, f64 rate, u8 paused
//   pose: f32 position x y z, rotation x y z w, scale
//
// The version is 1, or 2 where there is an edit of kind 5: who knows version 1 alone reads whatever it can understand.
#include <algorithm>

#include <spdlog/fmt/fmt.h>

#include "world/bytes.h"
#include "world/world.h"

namespace helio::world {
namespace {

constexpr uint8_t kVersion = 2;
enum class Kind : uint8_t { build = 1, destroy = 2, move = 3, environment = 4, time = 5 };
static_assert(std::variant_size_v<ResolvedEdit> == 5, "a new kind of edit needs its own number here");

constexpr size_t kSmallestEditBytes = sizeof(Kind) + sizeof(uint32_t);  // a destroy of nothing

void kind(Writer& out, Kind value) { out.integer(static_cast<uint8_t>(value)); }

void write(Writer& out, const ResolvedBuild& build) {
  kind(out, Kind::build);
  out.integer(build.prefab);
  out.integer(build.first_id);
  out.integer(static_cast<uint32_t>(build.poses.size()));
  out.reserve(build.poses.size() * kPoseBytes);
  for (const Pose& pose : build.poses) out.pose(pose);
}

void write(Writer& out, const ResolvedDestroy& destroy) {
  kind(out, Kind::destroy);
  out.integer(static_cast<uint32_t>(destroy.ids.size()));
  out.reserve(destroy.ids.size() * sizeof(InstanceId));
  for (InstanceId id : destroy.ids) out.integer(id);
}

void write(Writer& out, const ResolvedMove& move) {
  kind(out, Kind::move);
  out.integer(move.id);
  out.pose(move.pose);
}

void write(Writer& out, const ResolvedEnvironment& change) {
  kind(out, Kind::environment);
  out.environment(change.environment);
}

void write(Writer& out, const ResolvedTime& change) {
  kind(out, Kind::time);
  out.clock(change.clock);
}

uint8_t versionOf(const Batch& batch) {
  const auto is_newer = [](const ResolvedEdit& edit) { return std::holds_alternative<ResolvedTime>(edit); };
  return std::any_of(batch.edits.begin(), batch.edits.end(), is_newer) ? 2 : 1;
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

Error malformed(size_t position, std::string value, const std::string& why) {
  return {ErrorKind::damaged,
          fmt::format("batch: {} at byte {}, the log is damaged", why, position),
          "batch",
          std::move(value),
          {}};
}

}  // namespace

std::string encode(const Batch& batch) {
  Writer out;
  out.integer(versionOf(batch));
  out.integer(batch.tick);
  out.real(batch.time);
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
  if (version > kVersion) {
    return Error{
        ErrorKind::unsupported,
        fmt::format("batch: version {}, this server knows versions up to {}: start the newer one", version, kVersion),
        "batch", fmt::format("{}", version), fmt::format("{}", kVersion)};
  }
  if (version == 0) return malformed(0, "0", "version 0");
  Batch batch;
  batch.tick = in.integer<uint64_t>();
  batch.time = in.realDouble();
  const uint32_t edits = in.count(kSmallestEditBytes);
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
        batch.edits.push_back(ResolvedEnvironment{in.environment()});
        break;
      case Kind::time:
        batch.edits.push_back(ResolvedTime{in.clock()});
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
  if (version != versionOf(batch))
    return malformed(0, fmt::format("{}", version),
                     fmt::format("version {} where its edits make it {}", version, versionOf(batch)));
  return batch;
}

}  // namespace helio::world
