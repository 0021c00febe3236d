// glTF files made by code, good ones and bad ones.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace helio::scene {

/// A folder of the running test's own, gone with it.
class TempFolder {
 public:
  TempFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("heliograph-") + test->test_suite_name() + "-" + test->name();
    for (char& c : name) {
      if (c == '/') c = '-';
    }
    path_ = std::filesystem::temp_directory_path() / (name + "-" + std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
    return file;
  }

 private:
  std::filesystem::path path_;
};

template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

enum ComponentType {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

/// A PNG of width * height RGBA texels.
inline std::string png(int width, int height, const std::vector<uint8_t>& rgba) {
  std::string bytes;
  const auto append = [](void* to, void* data, int size) {
    static_cast<std::string*>(to)->append(static_cast<char*>(data), static_cast<size_t>(size));
  };
  stbi_write_png_to_func(append, &bytes, width, height, 4, rgba.data(), width * 4);
  return bytes;
}

/// A document and the bytes of its one buffer. Starts with one triangle in the plane z = 0: mesh 0 of accessor 0, which
/// node 0 places.
struct GltfBuilder {
  nlohmann::json document = {
      {"asset", {{"version", "2.0"}}},
      {"scene", 0},
      {"scenes", {{{"nodes", {0}}}}},
      {"nodes", {{{"mesh", 0}}}},
      {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
      {"buffers", nlohmann::json::array()},
      {"bufferViews", nlohmann::json::array()},
      {"accessors", nlohmann::json::array()},
  };
  std::string bin;

  GltfBuilder() { floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"); }

  nlohmann::json& primitive() { return document["meshes"][0]["primitives"][0]; }
  nlohmann::json& attributes() { return primitive()["attributes"]; }

  int view(const std::string& bytes) {
    bin.resize((bin.size() + 3) / 4 * 4);
    document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}});
    bin += bytes;
    return static_cast<int>(document["bufferViews"].size()) - 1;
  }
  int accessor(int view, size_t offset, ComponentType component, size_t count, const std::string& type) {
    document["accessors"].push_back(
        {{"bufferView", view}, {"byteOffset", offset}, {"componentType", component}, {"count", count}, {"type", type}});
    return static_cast<int>(document["accessors"].size()) - 1;
  }
  int floats(const std::vector<float>& values, const std::string& type) {
    const size_t components = type == "SCALAR" ? 1 : static_cast<size_t>(type[3] - '0');
    return accessor(view(bytesOf(values)), 0, kFloat, values.size() / components, type);
  }
  template <typename T>
  int indices(ComponentType component, const std::vector<T>& values) {
    return accessor(view(bytesOf(values)), 0, component, values.size(), "SCALAR");
  }
  /// Integers in elements that begin at multiples of 4 bytes, as vertex attributes must.
  template <typename T>
  int integers(ComponentType component, const std::string& type, bool normalized, const std::vector<T>& values) {
    const size_t components = type == "SCALAR" ? 1 : static_cast<size_t>(type[3] - '0');
    const size_t stride = (components * sizeof(T) + 3) / 4 * 4, count = values.size() / components;
    std::string bytes(count * stride, '\0');
    for (size_t i = 0; i < count; ++i)
      std::memcpy(bytes.data() + i * stride, values.data() + i * components, components * sizeof(T));
    const int made = accessor(view(bytes), 0, component, count, type);
    document["bufferViews"].back()["byteStride"] = stride;
    document["accessors"].back()["normalized"] = normalized;
    return made;
  }
  /// Replaces elements of an accessor of floats.
  void sparse(int accessor, const std::vector<uint16_t>& which, const std::vector<float>& values) {
    const int indices_view = view(bytesOf(which)), values_view = view(bytesOf(values));
    document["accessors"][static_cast<size_t>(accessor)]["sparse"] = {
        {"count", which.size()},
        {"indices", {{"bufferView", indices_view}, {"componentType", kUnsignedShort}}},
        {"values", {{"bufferView", values_view}}}};
  }
  void uses(const std::string& extension) { document["extensionsUsed"].push_back(extension); }
  int image(const std::string& encoded) {
    document["images"].push_back({{"bufferView", view(encoded)}, {"mimeType", "image/png"}});
    document["textures"].push_back({{"source", document["images"].size() - 1}});
    return static_cast<int>(document["textures"].size()) - 1;
  }

  /// Writes model.gltf and model.bin.
  std::filesystem::path save(const TempFolder& folder) const {
    nlohmann::json written = document;
    if (written["buffers"].empty()) written["buffers"] = {{{"uri", "model.bin"}, {"byteLength", bin.size()}}};
    folder.write("model.bin", bin);
    return folder.write("model.gltf", written.dump());
  }
  /// The same as the bytes of a GLB.
  std::string glb() const {
    nlohmann::json written = document;
    if (written["buffers"].empty()) written["buffers"] = {{{"byteLength", bin.size()}}};
    std::string text = written.dump(), binary = bin;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto u32 = [](size_t value) { return bytesOf(std::vector<uint32_t>{static_cast<uint32_t>(value)}); };
    return "glTF" + u32(2) + u32(12 + 8 + text.size() + 8 + binary.size()) + u32(text.size()) + "JSON" + text +
           u32(binary.size()) + std::string("BIN\0", 4) + binary;
  }
};

}  // namespace helio::scene
