#define TINYGLTF_IMPLEMENTATION
#include "scene/gltf_model.h"

#include <cstring>
#include <fstream>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>

#include <spdlog/fmt/fmt.h>

#include "scene/gltf_document.h"

namespace helio::scene {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxFileBytes = std::numeric_limits<uint32_t>::max();  // lengths in GLB, and in tinygltf's interface
constexpr uint32_t kGlbMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinChunk = 0x004e4942;

Result<std::vector<unsigned char>> readFile(const fs::path& path) {
  std::error_code problem;
  if (!fs::exists(path, problem)) return Error{ErrorKind::not_found, "there is no such file", "", "", {}};
  if (!fs::is_regular_file(path, problem)) return invalid("", "", "it is not a file");
  const uint64_t size = fs::file_size(path, problem);
  if (problem) return invalid("", "", problem.message());
  if (size > kMaxFileBytes) {
    return Error{ErrorKind::limit, fmt::format("it has {} bytes, at most {} can be read", size, kMaxFileBytes), "",
                 fmt::format("{}", size), fmt::format("{}", kMaxFileBytes)};
  }
  std::vector<unsigned char> bytes(size);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    return invalid("", "", "it cannot be read");
  return bytes;
}

// tinygltf looks for files in the model's folder and in the working directory, and follows links. Only what really lies
// in the folder exists for it.
const fs::path& folderOf(void* user_data) { return *static_cast<const fs::path*>(user_data); }

bool existsInFolder(const std::string& path, void* user_data) {
  std::error_code problem;
  const fs::path real = fs::canonical(path, problem);
  if (problem || !fs::is_regular_file(real, problem)) return false;
  const fs::path relative = real.lexically_relative(folderOf(user_data));
  return !relative.empty() && *relative.begin() != "..";
}

std::string samePath(const std::string& path, void*) { return path; }

bool readInFolder(std::vector<unsigned char>* out, std::string* error, const std::string& path, void* user_data) {
  if (!existsInFolder(path, user_data)) {
    *error = "it is not in the model's folder";
    return false;
  }
  Result<std::vector<unsigned char>> bytes = readFile(path);
  if (!bytes) {
    *error = bytes.error().message;
    return false;
  }
  *out = std::move(*bytes);
  return true;
}

bool writeNothing(std::string* error, const std::string&, const std::vector<unsigned char>&, void*) {
  *error = "models are only read";
  return false;
}

/// tinygltf 2.9 (Debian 13) asks for one callback more than 2.7 (Debian 12): a file's size.
template <typename Callbacks>
Callbacks callbacksFor(fs::path& folder) {
  Callbacks callbacks{};
  callbacks.FileExists = existsInFolder;
  callbacks.ExpandFilePath = samePath;
  callbacks.ReadWholeFile = readInFolder;
  callbacks.WriteWholeFile = writeNothing;
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
    callbacks.GetFileSizeInBytes = [](size_t* size, std::string* error, const std::string& path, void* user_data) {
      std::error_code problem;
      *size = existsInFolder(path, user_data) ? fs::file_size(path, problem) : 0;
      if (problem) *error = problem.message();
      return *size > 0 && !problem;
    };
  }
  callbacks.user_data = &folder;
  return callbacks;
}

bool keepEncoded(tinygltf::Image* image, const int index, std::string* error, std::string*, int, int,
                 const unsigned char* bytes, int size, void*) {
  if (size <= 0) {
    *error = fmt::format("images[{}] is too large to decode", index);
    return false;
  }
  image->image.assign(bytes, bytes + size);
  image->as_is = true;
  return true;
}

struct Container {
  std::string_view json;
  std::optional<uint64_t> bin_bytes;  ///< of a GLB
};

uint32_t littleEndian(std::span<const unsigned char> bytes, size_t offset) {
  return uint32_t{bytes[offset]} | uint32_t{bytes[offset + 1]} << 8 | uint32_t{bytes[offset + 2]} << 16 |
         uint32_t{bytes[offset + 3]} << 24;
}

/// Finds the JSON. A GLB's chunks are checked here in 64 bits: tinygltf lets the binary chunk end 8 bytes past the
/// file.
Result<Container> openContainer(std::span<const unsigned char> bytes) {
  const auto text = [&](size_t offset, size_t size) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()) + offset, size);
  };
  if (bytes.size() < 4) return invalid("", "", fmt::format("it has {} bytes and is no glTF", bytes.size()));
  if (littleEndian(bytes, 0) != kGlbMagic) return Container{text(0, bytes.size()), std::nullopt};

  const auto truncated = [&](const char* what, uint64_t needed) {
    return invalid(
        "GLB", fmt::format("{} bytes", bytes.size()),
        fmt::format("GLB: truncated, its {} needs {} bytes and the file has {}", what, needed, bytes.size()));
  };
  constexpr uint64_t kHeader = 12, kChunkHeader = 8;
  if (bytes.size() < kHeader + kChunkHeader) return truncated("header", kHeader + kChunkHeader);
  if (const uint32_t version = littleEndian(bytes, 4); version != 2) {
    return invalid("GLB.version", fmt::format("{}", version),
                   fmt::format("GLB.version is {}: only 2 can be read", version));
  }
  const uint64_t length = littleEndian(bytes, 8);
  if (length > bytes.size()) return truncated("length", length);

  const uint64_t json_bytes = littleEndian(bytes, 12);
  const uint64_t json_end = kHeader + kChunkHeader + json_bytes;
  if (littleEndian(bytes, 16) != kJsonChunk) return invalid("GLB", "", "GLB: its first chunk is not JSON");
  if (json_end > length) return truncated("JSON chunk", json_end);
  Container container{text(kHeader + kChunkHeader, json_bytes), 0};
  if (json_end + kChunkHeader > length) return container;  // no binary chunk

  const uint64_t bin_bytes = littleEndian(bytes, json_end);
  if (littleEndian(bytes, json_end + 4) != kBinChunk) return invalid("GLB", "", "GLB: its second chunk is not binary");
  if (json_end + kChunkHeader + bin_bytes > length)
    return truncated("binary chunk", json_end + kChunkHeader + bin_bytes);
  container.bin_bytes = bin_bytes;
  return container;
}

}  // namespace

Result<tinygltf::Model> loadModel(const fs::path& file) {
  const Result<std::vector<unsigned char>> bytes = readFile(file);
  if (!bytes) return bytes.error();
  const Result<Container> container = openContainer(*bytes);
  if (!container) return container.error();
  if (const Result<void> sound = checkDocument(container->json, container->bin_bytes); !sound) return sound.error();

  std::error_code problem;
  fs::path folder = fs::canonical(file, problem).parent_path();
  if (problem) return invalid("", "", problem.message());
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(callbacksFor<tinygltf::FsCallbacks>(folder));
  loader.SetImageLoader(keepEncoded, nullptr);

  tinygltf::Model model;
  std::string error, warning;
  bool loaded = false;
  try {
    const auto size = static_cast<unsigned int>(bytes->size());
    loaded = container->bin_bytes
                 ? loader.LoadBinaryFromMemory(&model, &error, &warning, bytes->data(), size, folder.string())
                 : loader.LoadASCIIFromString(&model, &error, &warning, reinterpret_cast<const char*>(bytes->data()),
                                              size, folder.string());
  } catch (const std::exception& thrown) {  // its JSON accessors throw on types that they do not expect
    error = thrown.what();
  }
  if (!loaded) {
    const std::string line = error.substr(0, error.find('\n'));
    return invalid("", "", line.empty() ? "it is no valid glTF" : line);
  }
  return model;
}

}  // namespace helio::scene
