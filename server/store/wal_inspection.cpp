#include "store/wal_inspection.h"

#include <spdlog/fmt/fmt.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace helio::store {
namespace {

constexpr size_t kHeaderBytes = 32, kFrameHeaderBytes = 24;
constexpr uint32_t kMagic = 0x377f0682;  // + 1: checksums are over big-endian words

/// A file through SQLite's eyes, so that the test's file system is looked at in the same way.
class VfsFile {
 public:
  VfsFile(const std::string& path, const char* vfs_name) : vfs_(sqlite3_vfs_find(vfs_name)) {
    int exists = 0;
    if (!vfs_ || vfs_->xAccess(vfs_, path.c_str(), SQLITE_ACCESS_EXISTS, &exists) != SQLITE_OK || !exists) return;
    file_bytes_.resize(static_cast<size_t>(vfs_->szOsFile));
    auto* file = reinterpret_cast<sqlite3_file*>(file_bytes_.data());
    file->pMethods = nullptr;
    name_ = sqlite3_create_filename(path.c_str(), "", path.c_str(), 0, nullptr);
    int flags = 0;
    if (vfs_->xOpen(vfs_, name_, file, SQLITE_OPEN_READONLY | SQLITE_OPEN_WAL, &flags) == SQLITE_OK) file_ = file;
    else failed_ = true;
  }
  ~VfsFile() {
    if (file_) file_->pMethods->xClose(file_);
    sqlite3_free_filename(name_);
  }
  VfsFile(const VfsFile&) = delete;
  VfsFile& operator=(const VfsFile&) = delete;

  bool failed() const { return failed_; }
  uint64_t size() {
    sqlite3_int64 size = 0;
    if (file_ && file_->pMethods->xFileSize(file_, &size) != SQLITE_OK) failed_ = true;
    return static_cast<uint64_t>(size);
  }
  bool read(uint64_t offset, std::vector<uint8_t>& into) {
    if (file_ && file_->pMethods->xRead(file_, into.data(), int(into.size()), sqlite3_int64(offset)) == SQLITE_OK)
      return true;
    failed_ = true;
    return false;
  }

 private:
  sqlite3_vfs* vfs_;
  sqlite3_filename name_ = nullptr;
  std::vector<char> file_bytes_;
  sqlite3_file* file_ = nullptr;
  bool failed_ = false;
};

uint32_t bigEndian(const uint8_t* p) {
  return uint32_t{p[0]} << 24 | uint32_t{p[1]} << 16 | uint32_t{p[2]} << 8 | uint32_t{p[3]};
}
uint32_t littleEndian(const uint8_t* p) {
  return uint32_t{p[3]} << 24 | uint32_t{p[2]} << 16 | uint32_t{p[1]} << 8 | uint32_t{p[0]};
}

/// Runs on over the header and all frames: a frame is only as good as everything before it.
struct Checksum {
  uint32_t s0 = 0, s1 = 0;
  bool big_endian = false;

  void add(const uint8_t* bytes, size_t count) {
    for (size_t i = 0; i < count; i += 8) {
      s0 += (big_endian ? bigEndian : littleEndian)(bytes + i) + s1;
      s1 += (big_endian ? bigEndian : littleEndian)(bytes + i + 4) + s0;
    }
  }
  bool matches(const uint8_t* stored) const { return bigEndian(stored) == s0 && bigEndian(stored + 4) == s1; }
};

struct Header {
  size_t page_bytes = 0;
  std::array<uint8_t, 8> salts{};
  Checksum checksum;
};

/// None: it is not one.
std::optional<Header> parse(const std::vector<uint8_t>& bytes) {
  Header header;
  const uint32_t magic = bigEndian(bytes.data());
  if (magic != kMagic && magic != kMagic + 1) return std::nullopt;
  header.checksum.big_endian = magic == kMagic + 1;
  header.page_bytes = bigEndian(&bytes[8]);
  std::copy_n(&bytes[16], 8, header.salts.begin());
  header.checksum.add(bytes.data(), 24);
  const bool is_page_size = header.page_bytes >= 512 && header.page_bytes <= 65536;
  if (!header.checksum.matches(&bytes[24]) || !is_page_size) return std::nullopt;
  return header;
}

constexpr uint64_t kSectorBytes = 512;  // what a disk writes whole, at least
/// The number of pages, which marks a commit, and the salts, which tell generations apart, may lie in two sectors: then
/// a crash may leave an older frame's mark beside the new one's salts.
bool markMayBeOlder(uint64_t frame) { return (frame + 4) / kSectorBytes != (frame + 8) / kSectorBytes; }

constexpr uint64_t kUsualPageBytes = 4096;  // SQLite's own choice, which the log leaves alone

}  // namespace

Error damagedWal(const std::string& path, const WalTail& tail) {
  return {ErrorKind::damaged,
          fmt::format("{} is damaged: {}; put back a copy that you trust, or give up at most {} transactions: helio "
                      "worlds repair --log-dir {} --accept-loss {}",
                      path, tail.damage, tail.lost_commits, std::filesystem::path(path).parent_path().string(),
                      tail.lost_commits),
          "log-dir",
          path,
          {}};
}

Result<WalTail> inspectWal(const std::string& path, const char* vfs) {
  VfsFile file(path, vfs);
  const uint64_t size = file.size();
  const Error unreadable{ErrorKind::unavailable, path + " cannot be read; look at the disk", "log-dir", path, {}};
  if (file.failed()) return unreadable;
  WalTail tail;
  if (size <= kHeaderBytes) {
    tail.incomplete_bytes = size;
    return tail;
  }
  std::vector<uint8_t> head(kHeaderBytes);
  if (!file.read(0, head)) return unreadable;
  auto header = parse(head);
  if (!header) {  // SQLite syncs the header before the first frame
    tail.damage = "frames without a header";
    tail.lost_commits = (size - kHeaderBytes) / (kFrameHeaderBytes + kUsualPageBytes);
    return tail;
  }

  const size_t frame_bytes = kFrameHeaderBytes + header->page_bytes;
  std::vector<uint8_t> frame(frame_bytes);
  bool trusted = true;                  // so far
  uint64_t trusted_end = kHeaderBytes;  // of the last commit
  uint64_t end = kHeaderBytes;          // of the last frame of this generation
  bool unit_ended = false;              // behind a frame that is not trusted, a commit was seen
  Checksum before;                      // as the frame before this one has it
  before.big_endian = header->checksum.big_endian;
  uint64_t at = kHeaderBytes;
  for (; at + frame_bytes <= size; at += frame_bytes) {
    if (!file.read(at, frame)) return unreadable;
    const bool this_generation = std::equal(header->salts.begin(), header->salts.end(), &frame[8]);
    Checksum checksum = trusted ? header->checksum : before;
    checksum.add(frame.data(), 8);
    checksum.add(&frame[kFrameHeaderBytes], header->page_bytes);
    const bool whole = checksum.matches(&frame[16]);  // by what is before it
    trusted = trusted && this_generation && whole;
    if (trusted) header->checksum = checksum;
    before.s0 = bigEndian(&frame[16]);
    before.s1 = bigEndian(&frame[20]);
    const bool commits = bigEndian(&frame[4]) != 0 && (whole || !markMayBeOlder(at));
    if (trusted && commits) {
      ++tail.commits;
      trusted_end = at + frame_bytes;
    }
    if (!this_generation) continue;  // left over from before the last checkpoint
    end = at + frame_bytes;
    if (trusted) continue;
    if (unit_ended && tail.damage.empty())
      tail.damage = fmt::format(
          "a frame before byte {} does not match its checksum, and a later transaction was begun "
          "after its own was complete",
          at);
    unit_ended |= commits;
    if (commits) ++tail.lost_commits;
  }
  if (at < size) end = size;  // the write was cut short within a frame
  tail.trusted_bytes = trusted_end;
  if (tail.damage.empty()) {
    tail.incomplete_bytes = end - trusted_end;
    tail.lost_commits = 0;  // one that was never complete, as far as anybody can tell
  }
  return tail;
}

}  // namespace helio::store
