#include "crash/forgetful_vfs.h"

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <map>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

namespace helio::crash {
namespace {

constexpr size_t kSectorBytes = 512;

/// A write, or with `truncates` a change of size to `offset`.
struct Change {
  uint64_t offset = 0;
  std::string bytes;
  bool truncates = false;
};

void applyTo(const Change& change, std::string& content) {
  if (change.truncates) {
    content.resize(change.offset);
  } else {
    content.resize(std::max<size_t>(content.size(), change.offset + change.bytes.size()));
    std::memcpy(content.data() + change.offset, change.bytes.data(), change.bytes.size());
  }
}

struct FileState {
  std::string now;     // what the process sees
  std::string synced;  // what the platters have
  std::vector<Change> unsynced;
  bool on_disk = false;  // its name has been synced
  bool deleted = false;  // but not its deletion
};

}  // namespace

struct ForgetfulVfs::Disk {
  std::string name;
  sqlite3_vfs vfs{};
  std::mutex mutex;
  std::mt19937_64 random;
  std::map<std::string, FileState> files;
  uint64_t left = std::numeric_limits<uint64_t>::max();  // operations until the crash
  bool crashed = false;
  uint64_t syncs = 0;
  std::atomic<int64_t> sync_ms = 0;

  /// Counts an operation. False: the process is no more.
  bool alive() {
    if (!crashed && left-- == 0) crashed = true;
    return !crashed;
  }
  FileState* find(const std::string& path) {
    const auto found = files.find(path);
    return found == files.end() || found->second.deleted ? nullptr : &found->second;
  }
  uint64_t below(uint64_t n) { return std::uniform_int_distribution<uint64_t>(0, n - 1)(random); }

  /// What became of a file's unsynced changes.
  void forget(FileState& file) {
    const uint64_t fate = below(3);  // of all, so that clean losses come as often as mixtures
    for (const Change& change : file.unsynced) {
      if (fate == 0) continue;
      if (change.truncates) {
        if (below(2) == 0) applyTo(change, file.synced);
        continue;
      }
      for (uint64_t at = 0; at < change.bytes.size();) {
        const uint64_t sector_end = (change.offset + at) / kSectorBytes * kSectorBytes + kSectorBytes;
        const uint64_t size = std::min<uint64_t>(change.bytes.size() - at, sector_end - (change.offset + at));
        const bool kept = fate == 1 || below(4) != 0;
        if (kept) applyTo({change.offset + at, change.bytes.substr(at, size), false}, file.synced);
        at += size;
      }
    }
  }
};

namespace {

using Disk = ForgetfulVfs::Disk;

struct OpenFile {
  sqlite3_file base;
  Disk* disk;
  std::string* path;  // SQLite owns the memory of this struct, and runs no destructor
  bool delete_on_close;
};

OpenFile& of(sqlite3_file* file) { return *reinterpret_cast<OpenFile*>(file); }
Disk& of(sqlite3_vfs* vfs) { return *static_cast<Disk*>(vfs->pAppData); }

int closeFile(sqlite3_file* file) {
  OpenFile& open = of(file);
  if (open.delete_on_close) {
    const std::lock_guard lock(open.disk->mutex);
    open.disk->files.erase(*open.path);
  }
  delete open.path;
  return SQLITE_OK;
}

int readFile(sqlite3_file* file, void* into, int size, sqlite3_int64 offset) {
  OpenFile& open = of(file);
  const std::lock_guard lock(open.disk->mutex);
  const FileState* state = open.disk->find(*open.path);
  if (open.disk->crashed || !state) return SQLITE_IOERR_READ;
  const auto wanted = static_cast<size_t>(size), at = static_cast<size_t>(offset);
  const size_t there = at < state->now.size() ? std::min(wanted, state->now.size() - at) : 0;
  std::memcpy(into, state->now.data() + std::min(at, state->now.size()), there);
  std::memset(static_cast<char*>(into) + there, 0, wanted - there);
  return there == wanted ? SQLITE_OK : SQLITE_IOERR_SHORT_READ;
}

int change(sqlite3_file* file, Change change, int error) {
  OpenFile& open = of(file);
  const std::lock_guard lock(open.disk->mutex);
  FileState* state = open.disk->find(*open.path);
  if (!state) return error;
  const bool was_alive = !open.disk->crashed, alive = open.disk->alive();
  if (was_alive) state->unsynced.push_back(change);  // the last one may have reached the disk, too
  if (!alive) return error;
  applyTo(change, state->now);
  return SQLITE_OK;
}

int writeFile(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 offset) {
  return change(
      file,
      {static_cast<uint64_t>(offset), std::string(static_cast<const char*>(bytes), static_cast<size_t>(size)), false},
      SQLITE_IOERR_WRITE);
}

int truncateFile(sqlite3_file* file, sqlite3_int64 size) {
  return change(file, {static_cast<uint64_t>(size), {}, true}, SQLITE_IOERR_TRUNCATE);
}

int syncFile(sqlite3_file* file, int) {
  OpenFile& open = of(file);
  std::this_thread::sleep_for(std::chrono::milliseconds(open.disk->sync_ms));
  const std::lock_guard lock(open.disk->mutex);
  FileState* state = open.disk->find(*open.path);
  if (!open.disk->alive() || !state) return SQLITE_IOERR_FSYNC;
  state->synced = state->now;
  state->unsynced.clear();
  state->on_disk = true;
  ++open.disk->syncs;
  return SQLITE_OK;
}

int fileSize(sqlite3_file* file, sqlite3_int64* size) {
  OpenFile& open = of(file);
  const std::lock_guard lock(open.disk->mutex);
  const FileState* state = open.disk->find(*open.path);
  if (open.disk->crashed || !state) return SQLITE_IOERR_FSTAT;
  *size = static_cast<sqlite3_int64>(state->now.size());
  return SQLITE_OK;
}

// One connection at a time: there is nobody to be locked out.
int lockFile(sqlite3_file*, int) { return SQLITE_OK; }
int checkReservedLock(sqlite3_file*, int* reserved) {
  *reserved = 0;
  return SQLITE_OK;
}
int fileControl(sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; }
int sectorSize(sqlite3_file*) { return kSectorBytes; }
int deviceCharacteristics(sqlite3_file*) { return SQLITE_IOCAP_POWERSAFE_OVERWRITE; }  // as SQLite assumes of disks

constexpr sqlite3_io_methods kMethods = {
    1,        closeFile,         readFile,    writeFile,  truncateFile,          syncFile, fileSize, lockFile,
    lockFile, checkReservedLock, fileControl, sectorSize, deviceCharacteristics, nullptr,  nullptr,  nullptr,
    nullptr,  nullptr,           nullptr};

int openFile(sqlite3_vfs* vfs, const char* name, sqlite3_file* file, int flags, int* out_flags) {
  Disk& disk = of(vfs);
  file->pMethods = nullptr;
  const std::lock_guard lock(disk.mutex);
  const std::string path = name ? name : "temporary-" + std::to_string(disk.random());
  if (disk.crashed) return SQLITE_CANTOPEN;
  if (!disk.find(path)) {
    if ((flags & SQLITE_OPEN_CREATE) == 0) return SQLITE_CANTOPEN;
    disk.files[path] = {};
  }
  OpenFile& open = of(file);
  open.disk = &disk;
  open.path = new std::string(path);
  open.delete_on_close = (flags & SQLITE_OPEN_DELETEONCLOSE) != 0;
  open.base.pMethods = &kMethods;
  if (out_flags) *out_flags = flags;
  return SQLITE_OK;
}

int deleteFile(sqlite3_vfs* vfs, const char* name, int sync_folder) {
  Disk& disk = of(vfs);
  const std::lock_guard lock(disk.mutex);
  if (!disk.alive()) return SQLITE_IOERR_DELETE;
  FileState* state = disk.find(name);
  if (!state) return SQLITE_IOERR_DELETE_NOENT;
  if (sync_folder || !state->on_disk) disk.files.erase(name);
  else state->deleted = true;
  return SQLITE_OK;
}

int accessFile(sqlite3_vfs* vfs, const char* name, int, int* exists) {
  Disk& disk = of(vfs);
  const std::lock_guard lock(disk.mutex);
  *exists = disk.find(name) != nullptr;
  return SQLITE_OK;
}

int fullPathname(sqlite3_vfs*, const char* name, int size, char* out) {
  sqlite3_snprintf(size, out, "%s", name);
  return SQLITE_OK;
}

sqlite3_vfs& systemVfs() { return *sqlite3_vfs_find("unix"); }
int randomness(sqlite3_vfs* vfs, int size, char* out) {
  Disk& disk = of(vfs);
  const std::lock_guard lock(disk.mutex);
  for (int i = 0; i < size; ++i) out[i] = static_cast<char>(disk.random());
  return size;
}
int sleepFor(sqlite3_vfs*, int microseconds) { return systemVfs().xSleep(&systemVfs(), microseconds); }
int currentTime(sqlite3_vfs*, double* time) { return systemVfs().xCurrentTime(&systemVfs(), time); }
int lastError(sqlite3_vfs*, int, char*) { return 0; }

}  // namespace

ForgetfulVfs::ForgetfulVfs(std::string name, uint64_t seed) : disk_(std::make_unique<Disk>()) {
  disk_->name = std::move(name);
  disk_->random.seed(seed);
  sqlite3_vfs& vfs = disk_->vfs;
  vfs.iVersion = 1;
  vfs.szOsFile = sizeof(OpenFile);
  vfs.mxPathname = 512;
  vfs.zName = disk_->name.c_str();
  vfs.pAppData = disk_.get();
  vfs.xOpen = openFile;
  vfs.xDelete = deleteFile;
  vfs.xAccess = accessFile;
  vfs.xFullPathname = fullPathname;
  vfs.xRandomness = randomness;
  vfs.xSleep = sleepFor;
  vfs.xCurrentTime = currentTime;
  vfs.xGetLastError = lastError;
  sqlite3_initialize();
  sqlite3_vfs_register(&vfs, 0);
}

ForgetfulVfs::~ForgetfulVfs() { sqlite3_vfs_unregister(&disk_->vfs); }

const std::string& ForgetfulVfs::name() const { return disk_->name; }

void ForgetfulVfs::crashAfter(uint64_t operations) {
  const std::lock_guard lock(disk_->mutex);
  disk_->left = operations;
}

void ForgetfulVfs::crashNow() {
  const std::lock_guard lock(disk_->mutex);
  disk_->crashed = true;
}

bool ForgetfulVfs::crashed() const {
  const std::lock_guard lock(disk_->mutex);
  return disk_->crashed;
}

void ForgetfulVfs::setSyncTime(std::chrono::milliseconds time) { disk_->sync_ms = time.count(); }

uint64_t ForgetfulVfs::syncs() const {
  const std::lock_guard lock(disk_->mutex);
  return disk_->syncs;
}

void ForgetfulVfs::restart() {
  const std::lock_guard lock(disk_->mutex);
  for (auto entry = disk_->files.begin(); entry != disk_->files.end();) {
    FileState& file = entry->second;
    disk_->forget(file);
    const bool gone = (!file.on_disk && disk_->below(2) == 0) || (file.deleted && disk_->below(2) == 0);
    if (gone) {
      entry = disk_->files.erase(entry);
      continue;
    }
    file.now = file.synced;
    file.unsynced.clear();
    file.on_disk = true;
    file.deleted = false;
    ++entry;
  }
  disk_->crashed = false;
  disk_->left = std::numeric_limits<uint64_t>::max();
}

void ForgetfulVfs::clear() {
  const std::lock_guard lock(disk_->mutex);
  disk_->files.clear();
}

}  // namespace helio::crash
