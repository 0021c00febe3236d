// An SQLite file system in memory that forgets, when the crash comes, what was not synced: all of it, or any part.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace helio::crash {

/// Registered with SQLite under its name for as long as it lives. Thread-safe.
///
/// What a crash may do, as disks do it: each write since a file's last sync is kept, lost, or torn between sectors of
/// 512 bytes, independently of the others; a file that was never synced may be gone; a file that was deleted without
/// syncing its folder may be back. What was synced stays.
class ForgetfulVfs {
 public:
  ForgetfulVfs(std::string name, uint64_t seed);
  ~ForgetfulVfs();
  ForgetfulVfs(const ForgetfulVfs&) = delete;
  ForgetfulVfs& operator=(const ForgetfulVfs&) = delete;

  const std::string& name() const;

  /// The crash comes at the `operations`-th write, sync, truncation or deletion from now: it and everything after it
  /// fails, as to a process that is no more.
  void crashAfter(uint64_t operations);
  /// Makes it come now, if it has not.
  void crashNow();
  bool crashed() const;
  /// How long a sync takes; at first no time.
  void setSyncTime(std::chrono::milliseconds time);
  /// Syncs since the beginning.
  uint64_t syncs() const;
  /// Once nobody has a file open any more: the disk as the next process finds it.
  void restart();
  /// An empty disk.
  void clear();

  struct Disk;

 private:
  std::unique_ptr<Disk> disk_;
};

}  // namespace helio::crash
