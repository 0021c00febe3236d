// A log's files, as a crash or a bad disk leaves them.
#pragma once

#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>
#include <sqlite3.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "store/sqlite_edit_log.h"
#include "store/wal_inspection.h"

namespace helio::store {

namespace fs = std::filesystem;

/// A folder that goes with the object.
class Folder {
 public:
  Folder() {
    std::string name = ::testing::TempDir() + "heliograph_log_XXXXXX";
    path_ = mkdtemp(name.data());
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  operator const fs::path&() const { return path_; }
  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

inline SqliteLogOptions optionsFor(const fs::path& folder) {
  SqliteLogOptions options;
  options.folder = folder;
  options.on_fatal = [](const Error& error) { ADD_FAILURE() << "fatal: " << error.message; };
  return options;
}

inline std::unique_ptr<EditLog> mustOpen(const fs::path& folder) {
  auto log = openSqliteEditLog(optionsFor(folder));
  EXPECT_TRUE(log) << log.error().message;
  return log ? std::move(*log) : nullptr;
}

inline Record record(uint64_t seq) {
  return {seq, fmt::format("r{}", seq), fmt::format("bytes of {}", seq), fmt::format("receipt of {}", seq)};
}

/// A log of world "w" with records 1..count, closed as a crash leaves it: everything is still in the WAL.
inline void writeAndCrash(const fs::path& folder, uint64_t count) {
  const Folder other;
  {
    const auto log = mustOpen(other);
    const auto epoch = log->acquire("w");
    for (uint64_t seq = 1; seq <= count; ++seq) ASSERT_EQ(log->append("w", *epoch, record(seq)), Append::ok);
    for (const char* name : {"edits.db", "edits.db-wal"}) fs::copy_file(other / name, folder / name);
  }
}

/// Changes a byte of a file.
inline void damage(const fs::path& file, uint64_t offset) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(offset));
  const char byte = static_cast<char>(stream.get() ^ 0x55);
  stream.seekp(static_cast<std::streamoff>(offset));
  stream.put(byte);
  ASSERT_TRUE(stream.good()) << file << " at " << offset;
}

inline std::string contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The only place where `text` lies in the file.
inline uint64_t offsetOf(const fs::path& file, const std::string& text) {
  const std::string bytes = contents(file);
  const size_t found = bytes.find(text);
  EXPECT_NE(found, std::string::npos) << text;
  return found;
}

inline Error errorOfOpening(const fs::path& folder) {
  const auto log = openSqliteEditLog(optionsFor(folder));
  EXPECT_FALSE(log);
  return log ? Error{} : log.error();
}

/// With another SQLite connection, while no log is open.
inline void sql(const fs::path& folder, const std::string& statements) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder / "edits.db").c_str(), &database), SQLITE_OK);
  char* error = nullptr;
  EXPECT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, &error), SQLITE_OK) << error;
  sqlite3_close(database);
}

}  // namespace helio::store
