#include "service/world_log.h"

#include <heliograph/v1/world.pb.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

namespace helio::service {
namespace {

constexpr size_t kRecordsAtOnce = 64;  // a record may weigh 3 MB

EditAnswer answer(uint64_t seq, uint64_t epoch, const world::Batch& batch) {
  EditAnswer out;
  out.seq = seq;
  out.epoch = epoch;
  for (const auto& edit : batch.edits) {
    if (const auto* build = std::get_if<world::ResolvedBuild>(&edit))
      out.built.push_back({build->first_id, build->poses.size()});
    else if (const auto* destroy = std::get_if<world::ResolvedDestroy>(&edit)) out.destroyed += destroy->ids.size();
  }
  return out;
}

// A receipt is the answer as it went over the wire.
std::string receiptOf(const EditAnswer& answer) {
  v1::ApplyEditsResponse receipt;
  receipt.set_seq(answer.seq);
  receipt.set_epoch(answer.epoch);
  for (const auto& built : answer.built) {
    auto& range = *receipt.add_built();
    range.set_first(built.first);
    range.set_count(built.count);
  }
  receipt.set_destroyed(answer.destroyed);
  return receipt.SerializeAsString();
}

std::optional<EditAnswer> answerOf(const std::string& bytes) {
  v1::ApplyEditsResponse receipt;
  if (!receipt.ParseFromString(bytes)) return std::nullopt;
  EditAnswer out{receipt.seq(), receipt.epoch(), {}, receipt.destroyed(), true};
  for (const auto& range : receipt.built()) out.built.push_back({range.first(), range.count()});
  return out;
}

}  // namespace

Result<void> enterIntoLog(store::EditLog& log, const std::string& world, const Manifest& manifest) {
  const auto epoch = log.acquire(world);
  if (!epoch) return epoch.error();
  return log.putManifest(world, *epoch, encode(manifest));
}

WorldLog::WorldLog(const std::string& world, store::EditLog& log, uint64_t snapshot_bytes,
                   std::function<void(const Error&)> on_fatal)
    : world_(world), log_(log), snapshot_bytes_(snapshot_bytes), on_fatal_(std::move(on_fatal)) {}

WorldLog::~WorldLog() {
  {
    const std::lock_guard lock(snapshot_mutex_);
    stopping_ = true;
    snapshot_due_.notify_all();
  }
  if (snapshots_.joinable()) snapshots_.join();
}

// ---- Loading
// ---------------------------------------------------------------------------------------------------------

Result<std::unique_ptr<world::World>> WorldLog::load(const scene::ScenePtr& scene, const WorldSource& source,
                                                     const world::Limits& limits) {
  const auto epoch = log_.acquire(world_);
  if (!epoch) return epoch.error();
  epoch_ = *epoch;
  if (auto same = checkScene(*scene, source.manifest); !same) return same.error();
  auto world = std::make_unique<world::World>(scene, limits);
  if (auto restored = restore(*world); !restored) return restored.error();
  snapshots_ = std::thread([this, w = world.get()] { writeSnapshots(*w); });
  return world;
}

/// The first time the scene's digest is noted; from then on it must stay the same.
Result<void> WorldLog::checkScene(const scene::Scene& scene, Manifest manifest) {
  const std::string digest = digestOf(scene, manifest);
  if (manifest.digest.empty()) {
    manifest.digest = digest;
    return log_.putManifest(world_, epoch_, encode(manifest));
  }
  if (manifest.digest == digest) return {};
  return Error{ErrorKind::unsupported,
               manifest.description() +
                   " is not the scene any more that the world's edits were made in; put it back as "
                   "it was, or delete the world",
               "world", digest, manifest.digest};
}

Result<void> WorldLog::restore(world::World& world) {
  const auto snapshot = log_.snapshot(world_);
  if (!snapshot) return snapshot.error();
  if (*snapshot) {
    if (auto restored = world.restore({(*snapshot)->seq, (*snapshot)->bytes}); !restored) return restored;
    last_snapshot_bytes_ = (*snapshot)->bytes.size();
  }
  const auto bytes = catchUp(world);
  if (!bytes) return bytes.error();
  bytes_since_snapshot_ = *bytes;
  return {};
}

/// Applies what the log has and the world has not; returns how much that was, in bytes.
Result<uint64_t> WorldLog::catchUp(world::World& world) {
  uint64_t bytes = 0;
  for (;;) {
    const auto records = log_.read(world_, world.seq(), kRecordsAtOnce);
    if (!records) return records.error();
    if (records->empty()) return bytes;
    for (const store::Record& record : *records) {
      const auto batch = world::decode(std::as_bytes(std::span(record.bytes)));
      if (!batch) return batch.error();
      if (auto applied = world.apply(record.seq, *batch); !applied)
        return Error{ErrorKind::damaged,
                     fmt::format("record {} does not fit the world: {}", record.seq, applied.error().message),
                     "world",
                     world_,
                     {}};
      bytes += record.bytes.size();
    }
  }
}

// ---- Edits
// -----------------------------------------------------------------------------------------------------------

Outcome<EditAnswer> WorldLog::apply(world::World& world, const EditRequest& request) {
  std::lock_guard lock(edit_mutex_);
  if (request.deadline <= std::chrono::system_clock::now()) return tooLate();  // others' edits took so long
  if (unsettled_) {
    if (!catchUp(world)) return outcomeUnknown(request.request_id);
    unsettled_ = false;
  }

  // A repeated request gets the first one's answer, whatever the world has become since.
  const auto first = replay(request.request_id);
  if (!first) return first.error();
  if (*first) return **first;

  // Check everything before anything changes.
  if (request.expected_seq && *request.expected_seq != world.seq()) {
    const std::string is = std::to_string(world.seq()), expected = std::to_string(*request.expected_seq);
    return Failure{v1::ERROR_REASON_SEQ_MISMATCH,
                   {ErrorKind::conflict,
                    "world \"" + world_ + "\" is at sequence number " + is + ", not " + expected +
                        "; look at what changed, then send the edits again",
                    "expected_seq", is, expected}};
  }
  auto batch = world.resolve(request.edits);
  if (!batch) return Failure(batch.error());

  // Make it durable, then apply it.
  const EditAnswer out = answer(world.seq() + 1, epoch_, *batch);
  const store::Record record{out.seq, request.request_id, world::encode(*batch), receiptOf(out)};
  switch (log_.append(world_, epoch_, record)) {
    case store::Append::ok:
      break;
    case store::Append::fenced:
      return moved(world_);
    case store::Append::unknown:
      unsettled_ = true;
      return outcomeUnknown(request.request_id);
    case store::Append::out_of_order:
      return diverged({ErrorKind::internal,
                       "the log of world \"" + world_ + "\" is not at the world's sequence number",
                       "seq",
                       std::to_string(out.seq),
                       {}});
  }
  if (auto applied = world.apply(out.seq, *batch); !applied) return diverged(applied.error());
  grew(record.bytes.size());
  return out;
}

Outcome<std::optional<EditAnswer>> WorldLog::replay(const std::string& request_id) const {
  const auto receipt = log_.receipt(world_, request_id);
  if (!receipt) return outcomeUnknown(request_id);
  if (!*receipt) return std::optional<EditAnswer>();
  const auto first = answerOf((*receipt)->bytes);
  if (!first)
    return diverged({ErrorKind::damaged, "the receipt of request \"" + request_id + "\" makes no sense", {}, {}, {}});
  return first;
}

/// World and log have come apart: nothing after this can be right.
Failure WorldLog::diverged(const Error& error) const {
  on_fatal_(error);
  return error;
}

Failure WorldLog::outcomeUnknown(const std::string& request_id) const {
  return {v1::ERROR_REASON_OUTCOME_UNKNOWN,
          {ErrorKind::unavailable,
           "the log gave no answer; repeat with the same request_id",
           "request_id",
           request_id,
           {}}};
}

// ---- Snapshots
// -------------------------------------------------------------------------------------------------------

void WorldLog::grew(uint64_t bytes) {
  const std::lock_guard lock(snapshot_mutex_);
  bytes_since_snapshot_ += bytes;
  snapshot_due_.notify_all();
}

/// A snapshot is due when the records since the last one weigh as much as it did: what is written stays below twice the
/// edits, and a restart reads at most about twice the world.
void WorldLog::writeSnapshots(world::World& world) {
  const auto due = [&] { return bytes_since_snapshot_ >= std::max(snapshot_bytes_, last_snapshot_bytes_); };
  std::unique_lock lock(snapshot_mutex_);
  for (;;) {
    snapshot_due_.wait(lock, [&] { return stopping_ || due(); });
    if (stopping_) return;
    bytes_since_snapshot_ = 0;
    lock.unlock();
    const auto written = writeSnapshot(world);
    lock.lock();
    if (written) last_snapshot_bytes_ = *written;
    else if (!stopping_) spdlog::warn("world {}: no snapshot was written: {}", world_, written.error().message);
  }
}

Result<size_t> WorldLog::writeSnapshot(world::World& world) {
  world::Saved saved = world.save();
  const store::Snapshot snapshot{saved.seq, std::move(saved.bytes)};
  if (auto put = log_.putSnapshot(world_, epoch_, snapshot); !put) return put.error();
  if (auto truncated = log_.truncate(world_, epoch_, snapshot.seq); !truncated) return truncated.error();
  spdlog::debug("world {}: snapshot at seq {}, {} bytes", world_, snapshot.seq, snapshot.bytes.size());
  return snapshot.bytes.size();
}

}  // namespace helio::service
