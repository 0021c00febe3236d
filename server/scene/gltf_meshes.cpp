#include <algorithm>
#include <numeric>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "scene/gltf_accessor.h"
#include "scene/gltf_import.h"

namespace helio::scene {
namespace {

constexpr float kTinyLength = 1e-12f;

/// The corners of triangles, as places in a list of `count` corners of a strip, a fan or single triangles.
std::vector<uint32_t> triangulate(int mode, uint32_t count) {
  std::vector<uint32_t> places;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    places.resize(count);
    std::iota(places.begin(), places.end(), 0u);
    return places;
  }
  places.reserve(size_t{3} * (count - 2));
  for (uint32_t i = 0; i + 2 < count; ++i) {
    const uint32_t odd = i % 2;
    if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      places.insert(places.end(), {i, i + 1 + odd, i + 2 - odd});
    } else {
      places.insert(places.end(), {i + 1, i + 2, 0u});
    }
  }
  return places;
}

glm::vec3 faceNormal(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::vec3 normal = glm::cross(b - a, c - a);
  const float length = glm::length(normal);
  return length > 0.0f && std::isfinite(length) ? normal / length : glm::vec3(0.0f, 1.0f, 0.0f);
}

class MeshImporter {
 public:
  MeshImporter(const tinygltf::Model& model, const GltfOptions& options, Scene& scene)
      : model_(model), options_(options), scene_(scene) {}

  Result<std::vector<uint32_t>> import() {
    std::vector<uint32_t> prefab_of_mesh(model_.meshes.size(), kNone);
    for (size_t i = 0; i < model_.meshes.size(); ++i) {
      const tinygltf::Mesh& from = model_.meshes[i];
      Mesh mesh;
      mesh.name = names_.take(from.name.empty() ? fmt::format("mesh_{}", i) : from.name);
      for (size_t k = 0; k < from.primitives.size(); ++k) {
        Result<Mesh> part = importPrimitive(from.primitives[k], fmt::format("meshes[{}].primitives[{}]", i, k));
        if (!part) return part.error();
        append(*part, from.primitives[k].material, mesh);
      }
      if (mesh.indices.empty()) continue;
      mesh.finish();
      prefab_of_mesh[i] = static_cast<uint32_t>(scene_.prefabs.size());
      scene_.prefabs.push_back({mesh.name, "model", static_cast<uint32_t>(scene_.meshes.size()), true});
      scene_.meshes.push_back(std::move(mesh));
    }
    return prefab_of_mesh;
  }

 private:
  /// A primitive as a finished mesh, empty when it has no triangles.
  Result<Mesh> importPrimitive(const tinygltf::Primitive& primitive, const std::string& at) {
    const bool has_surface = primitive.mode == TINYGLTF_MODE_TRIANGLES ||
                             primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
                             primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
    const auto position = primitive.attributes.find("POSITION");
    if (!has_surface || position == primitive.attributes.end()) {
      spdlog::warn("glTF: {} is left out: it has {}", at,
                   has_surface ? "no positions" : "points or lines, not triangles");
      return Mesh{};
    }
    const Result<AccessorView> positions = viewAccessor(model_, position->second);
    if (!positions) return positions.error();
    Result<std::vector<uint32_t>> corners = cornersOf(primitive, positions->count, at);
    if (!corners) return corners.error();

    // Without normals every face is flat, so its corners are its own vertices. Of vertices that many primitives share,
    // each takes those that it uses: memory follows the triangles, whatever a file repeats.
    std::vector<uint32_t> vertices;
    Mesh part;
    if (primitive.attributes.count("NORMAL") == 0) {
      vertices = std::move(*corners);
      part.indices.resize(vertices.size());
      std::iota(part.indices.begin(), part.indices.end(), 0u);
    } else if (positions->count <= corners->size()) {
      vertices.resize(positions->count);
      std::iota(vertices.begin(), vertices.end(), 0u);
      part.indices = std::move(*corners);
    } else {
      vertices = *corners;
      std::sort(vertices.begin(), vertices.end());
      vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
      part.indices.reserve(corners->size());
      for (uint32_t corner : *corners) {
        part.indices.push_back(
            static_cast<uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), corner) - vertices.begin()));
      }
    }

    Result<std::vector<glm::vec3>> read = readVectors(*positions, vertices);
    if (!read) return read.error();
    part.positions = std::move(*read);
    if (Result<void> done = readAttributes(primitive, positions->count, vertices, at, part); !done) return done.error();
    part.finish();
    return part;
  }

  Result<std::vector<uint32_t>> cornersOf(const tinygltf::Primitive& primitive, size_t vertex_count,
                                          const std::string& at) {
    AccessorView view;
    if (primitive.indices >= 0) {
      Result<AccessorView> indexed = viewAccessor(model_, primitive.indices);
      if (!indexed) return indexed.error();
      view = std::move(*indexed);
    }
    const size_t count = primitive.indices >= 0 ? view.count : vertex_count;
    const bool is_list = primitive.mode == TINYGLTF_MODE_TRIANGLES;
    if (count < 3 || (is_list && count % 3 != 0)) {
      return invalid(at, fmt::format("{}", count),
                     fmt::format("{} has {} corners: they make no whole number of triangles", at, count));
    }
    const size_t triangles = is_list ? count / 3 : count - 2;
    if (triangles > options_.max_triangles - triangles_) {
      return Error{ErrorKind::limit,
                   fmt::format("{} brings the model to {} triangles, at most {} are allowed", at,
                               triangles_ + triangles, options_.max_triangles),
                   at, fmt::format("{}", triangles_ + triangles), fmt::format("{}", options_.max_triangles)};
    }
    triangles_ += triangles;

    std::vector<uint32_t> corners = triangulate(primitive.mode, static_cast<uint32_t>(count));
    if (primitive.indices < 0) return corners;
    const Result<std::vector<uint32_t>> indices = readIndices(view, vertex_count);
    if (!indices) return indices.error();
    for (uint32_t& corner : corners) corner = (*indices)[corner];
    return corners;
  }

  Result<void> readAttributes(const tinygltf::Primitive& primitive, size_t vertex_count,
                              const std::vector<uint32_t>& vertices, const std::string& at, Mesh& part) {
    AccessorView view;
    if (Result<bool> has = find(primitive, "TEXCOORD_0", vertex_count, at, view); !has) {
      return has.error();
    } else if (*has) {
      Result<std::vector<glm::vec2>> uvs = readUvs(view, vertices);
      if (!uvs) return uvs.error();
      part.uvs = std::move(*uvs);
    }
    if (Result<bool> has = find(primitive, "NORMAL", vertex_count, at, view); !has) {
      return has.error();
    } else if (!*has) {
      addFlatNormals(part);
      return {};  // tangents of a surface whose normals are not given mean nothing
    }
    Result<std::vector<glm::vec3>> normals = readVectors(view, vertices);
    if (!normals) return normals.error();
    part.normals = std::move(*normals);
    normalise(part);

    if (Result<bool> has = find(primitive, "TANGENT", vertex_count, at, view); !has) {
      return has.error();
    } else if (*has) {
      Result<std::vector<glm::vec4>> tangents = readTangents(view, vertices);
      if (!tangents) return tangents.error();
      part.tangents = std::move(*tangents);
      const auto isUsable = [](const glm::vec4& t) { return glm::length(glm::vec3(t)) > kTinyLength; };
      if (!std::all_of(part.tangents.begin(), part.tangents.end(), isUsable))
        part.tangents.clear();  // finish() makes better ones
      for (glm::vec4& t : part.tangents) t = glm::vec4(glm::normalize(glm::vec3(t)), t.w < 0.0f ? -1.0f : 1.0f);
    }
    return {};
  }

  /// Whether the primitive has the attribute, as a view of one element a vertex.
  Result<bool> find(const tinygltf::Primitive& primitive, const char* attribute, size_t vertex_count,
                    const std::string& at, AccessorView& view) const {
    const auto entry = primitive.attributes.find(attribute);
    if (entry == primitive.attributes.end()) return false;
    Result<AccessorView> found = viewAccessor(model_, entry->second);
    if (!found) return found.error();
    view = std::move(*found);
    if (view.count != vertex_count) {
      const std::string field = fmt::format("{}.attributes.{}", at, attribute);
      return invalid(field, fmt::format("{}", view.count),
                     fmt::format("{} has {} elements for {} vertices", field, view.count, vertex_count));
    }
    return true;
  }

  static void addFlatNormals(Mesh& part) {
    part.normals.resize(part.positions.size());
    for (size_t i = 0; i + 2 < part.indices.size(); i += 3) {
      const glm::vec3 normal = faceNormal(part.positions[i], part.positions[i + 1], part.positions[i + 2]);
      for (size_t corner = i; corner < i + 3; ++corner) part.normals[corner] = normal;
    }
  }

  /// Unit lengths; a normal of no length becomes that of a face that uses it.
  static void normalise(Mesh& part) {
    for (size_t i = 0; i + 2 < part.indices.size(); i += 3) {
      const uint32_t a = part.indices[i], b = part.indices[i + 1], c = part.indices[i + 2];
      for (uint32_t v : {a, b, c}) {
        if (!(glm::length(part.normals[v]) > kTinyLength))
          part.normals[v] = faceNormal(part.positions[a], part.positions[b], part.positions[c]);
      }
    }
    for (glm::vec3& normal : part.normals) {
      const float length = glm::length(normal);
      normal = length > kTinyLength && std::isfinite(length) ? normal / length : glm::vec3(0.0f, 1.0f, 0.0f);
    }
  }

  void append(const Mesh& part, int material, Mesh& mesh) const {
    if (part.indices.empty()) return;
    const uint32_t base = static_cast<uint32_t>(mesh.positions.size());
    const auto default_material = static_cast<uint32_t>(model_.materials.size());
    mesh.submeshes.push_back({static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(part.indices.size()),
                              material >= 0 ? static_cast<uint32_t>(material) : default_material});
    mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
    mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
    mesh.tangents.insert(mesh.tangents.end(), part.tangents.begin(), part.tangents.end());
    mesh.uvs.insert(mesh.uvs.end(), part.uvs.begin(), part.uvs.end());
    for (uint32_t index : part.indices) mesh.indices.push_back(base + index);
  }

  const tinygltf::Model& model_;
  const GltfOptions& options_;
  Scene& scene_;
  UniqueNames names_;
  uint64_t triangles_ = 0;
};

}  // namespace

Result<std::vector<uint32_t>> importMeshes(const tinygltf::Model& model, const GltfOptions& options, Scene& scene) {
  return MeshImporter(model, options, scene).import();
}

}  // namespace helio::scene
