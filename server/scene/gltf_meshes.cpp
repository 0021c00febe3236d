#include <algorithm>
#include <cmath>
#include <numeric>

#include <spdlog/fmt/fmt.h>

#include "scene/cut_outs.h"
#include "scene/gltf_accessor.h"
#include "scene/gltf_extensions.h"
#include "scene/gltf_import.h"
#include "scene/levels_of_detail.h"
#include "scene/triangle_order.h"
#include "scene/vertex_frames.h"

namespace helio::scene {
namespace {

constexpr float kTinyLength = 1e-12f;
constexpr size_t kMaxMorphTargets = 64;

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

/// Channel k of a mesh, 0 being `uvs`.
std::vector<glm::vec2>& channel(Mesh& mesh, size_t k) { return k == 0 ? mesh.uvs : mesh.more_uvs[k - 1]; }

class MeshImporter {
 public:
  MeshImporter(GltfImport& import, const std::vector<UvChannels>& channels_of_material)
      : import_(import),
        model_(import.model),
        options_(import.options),
        scene_(import.scene),
        channels_of_material_(channels_of_material),
        quantized_(import.uses(kMeshQuantization)) {}

  Result<std::vector<uint32_t>> import() {
    std::vector<uint32_t> prefab_of_mesh(model_.meshes.size(), kNone);
    for (size_t i = 0; i < model_.meshes.size(); ++i) {
      const tinygltf::Mesh& from = model_.meshes[i];
      Mesh mesh;
      mesh.name = names_.take(from.name.empty() ? fmt::format("mesh_{}", i) : from.name);
      for (size_t k = 0; k < from.primitives.size(); ++k) {
        Result<Mesh> part = importPrimitive(from.primitives[k], fmt::format("meshes[{}].primitives[{}]", i, k));
        if (!part) return part.error();
        append(*part, materialOf(from.primitives[k]), mesh);
      }
      if (mesh.indices.empty()) continue;
      mesh.finish();
      import_.report.primitives += mesh.submeshes.size();
      splitCutOuts(mesh, scene_.materials, scene_.textures);
      if (mesh.indices.empty()) continue;
      orderTriangles(mesh);
      makeLevels(mesh, scene_.materials, Seams::keep);
      prefab_of_mesh[i] = static_cast<uint32_t>(scene_.prefabs.size());
      scene_.prefabs.push_back({mesh.name, "model", static_cast<uint32_t>(scene_.meshes.size()), true});
      scene_.meshes.push_back(std::move(mesh));
    }
    import_.report.meshes = scene_.meshes.size();
    import_.report.triangles = triangles_;
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
      import_.report.ignore(has_surface ? "primitives without positions" : "points and lines",
                            "only triangles have surfaces");
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

    Result<std::vector<glm::vec3>> read = readVec3(*positions, vertices, quantized_ ? Integers::any : Integers::none);
    if (!read) return read.error();
    part.positions = std::move(*read);
    const Source source{primitive, vertices, positions->count, at};
    for (const auto readAttribute :
         {&MeshImporter::readUvs, &MeshImporter::readVertexColors, &MeshImporter::readNormals, &MeshImporter::readSkin,
          &MeshImporter::readMorphTargets}) {
      if (Result<void> done = (this->*readAttribute)(source, part); !done) return done.error();
    }
    addTangents(materialOf(primitive), part);
    part.finish();
    return part;
  }

  uint32_t materialOf(const tinygltf::Primitive& primitive) const {
    return static_cast<uint32_t>(primitive.material >= 0 ? static_cast<size_t>(primitive.material)
                                                         : model_.materials.size());
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

  /// A primitive, and which of its `vertex_count` vertices are read.
  struct Source {
    const tinygltf::Primitive& primitive;
    const std::vector<uint32_t>& vertices;
    size_t vertex_count;
    const std::string& at;
  };

  /// The channels that the material's textures read, transformed.
  Result<void> readUvs(const Source& source, Mesh& part) {
    const UvChannels& channels = channels_of_material_[materialOf(source.primitive)];
    part.more_uvs.resize(channels.size() - 1);
    for (size_t k = 0; k < channels.size(); ++k) {
      const std::string attribute = fmt::format("TEXCOORD_{}", channels[k].set);
      AccessorView view;
      const Result<bool> has = find(source, attribute, view);
      if (!has) return has.error();
      if (!*has) {
        channel(part, k).assign(source.vertices.size(), channels[k](glm::vec2(0.0f)));
        continue;
      }
      Result<std::vector<glm::vec2>> uvs =
          readVec2(view, source.vertices, quantized_ ? Integers::any : Integers::normalized_unsigned);
      if (!uvs) return uvs.error();
      if (!channels[k].identity()) {
        for (glm::vec2& uv : *uvs) {
          uv = channels[k](uv);
          if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) {
            return invalid(source.at, "",
                           fmt::format("{}: the texture transform of its material takes {} beyond what "
                                       "numbers can hold",
                                       source.at, attribute));
          }
        }
      }
      channel(part, k) = std::move(*uvs);
    }
    return {};
  }

  Result<void> readVertexColors(const Source& source, Mesh& part) {
    if (source.primitive.attributes.count("COLOR_1") != 0)
      import_.report.ignore("vertex colours beyond COLOR_0", "glTF gives them no meaning");
    AccessorView view;
    const Result<bool> has = find(source, "COLOR_0", view);
    if (!has) return has.error();
    if (!*has) return {};
    Result<std::vector<glm::vec4>> colors = readColors(view, source.vertices);
    if (!colors) return colors.error();
    part.colors = std::move(*colors);
    return {};
  }

  Result<void> readSkin(const Source& source, Mesh& part) {
    if (source.primitive.attributes.count("JOINTS_1") != 0)
      import_.report.ignore("joints beyond four a vertex", "the first four carry it");
    AccessorView joints_view, weights_view;
    const Result<bool> has_joints = find(source, "JOINTS_0", joints_view);
    if (!has_joints) return has_joints.error();
    const Result<bool> has_weights = find(source, "WEIGHTS_0", weights_view);
    if (!has_weights) return has_weights.error();
    if (!*has_joints || !*has_weights) return {};
    const auto joints = readJoints(joints_view, source.vertices);
    if (!joints) return joints.error();
    const auto weights = readVec4(weights_view, source.vertices, Integers::normalized_unsigned);
    if (!weights) return weights.error();
    part.skin.resize(joints->size());
    for (size_t i = 0; i < joints->size(); ++i) {
      const glm::vec4 w = glm::max((*weights)[i], glm::vec4(0.0f));
      const float sum = w.x + w.y + w.z + w.w;
      part.skin[i] = {(*joints)[i], sum > 1e-6f && std::isfinite(sum) ? w / sum : glm::vec4(1.0f, 0.0f, 0.0f, 0.0f)};
    }
    return {};
  }

  Result<void> readMorphTargets(const Source& source, Mesh& part) {
    const size_t count = source.primitive.targets.size();
    if (count > kMaxMorphTargets) {
      const std::string field = source.at + ".targets";
      return Error{ErrorKind::limit,
                   fmt::format("{}: {} morph targets, at most {} are allowed", field, count, kMaxMorphTargets), field,
                   fmt::format("{}", count), fmt::format("{}", kMaxMorphTargets)};
    }
    for (size_t t = 0; t < count; ++t) {
      MorphTarget target{std::vector<glm::vec3>(part.positions.size(), glm::vec3(0.0f)),
                         std::vector<glm::vec3>(part.positions.size(), glm::vec3(0.0f))};
      for (const auto& [attribute, accessor] : source.primitive.targets[t]) {
        if (attribute != "POSITION" && attribute != "NORMAL") continue;  // tangents follow the normals well enough
        const Result<AccessorView> view = viewAccessor(model_, accessor);
        if (!view) return view.error();
        if (view->count != source.vertex_count) {
          const std::string field = fmt::format("{}.targets[{}].{}", source.at, t, attribute);
          return invalid(field, fmt::format("{}", view->count),
                         fmt::format("{} has {} elements for {} vertices", field, view->count, source.vertex_count));
        }
        auto deltas = readVec3(*view, source.vertices, quantized_ ? Integers::any : Integers::none);
        if (!deltas) return deltas.error();
        (attribute == "POSITION" ? target.positions : target.normals) = std::move(*deltas);
      }
      part.morph_targets.push_back(std::move(target));
    }
    return {};
  }

  /// Normals, and the tangents that belong to them.
  Result<void> readNormals(const Source& source, Mesh& part) {
    const Integers allowed = quantized_ ? Integers::normalized_signed : Integers::none;
    AccessorView view;
    if (Result<bool> has = find(source, "NORMAL", view); !has) {
      return has.error();
    } else if (!*has) {
      addFlatNormals(part);
      return {};  // tangents of a surface whose normals are not given mean nothing
    }
    Result<std::vector<glm::vec3>> normals = readVec3(view, source.vertices, allowed);
    if (!normals) return normals.error();
    part.normals = std::move(*normals);
    normalise(part);

    if (Result<bool> has = find(source, "TANGENT", view); !has) {
      return has.error();
    } else if (*has) {
      Result<std::vector<glm::vec4>> tangents = readVec4(view, source.vertices, allowed);
      if (!tangents) return tangents.error();
      part.tangents = std::move(*tangents);
      const auto isUsable = [](const glm::vec4& t) { return glm::length(glm::vec3(t)) > kTinyLength; };
      if (!std::all_of(part.tangents.begin(), part.tangents.end(), isUsable))
        part.tangents.clear();  // addTangents() makes better ones
      for (glm::vec4& t : part.tangents) t = glm::vec4(glm::normalize(glm::vec3(t)), t.w < 0.0f ? -1.0f : 1.0f);
    }
    return {};
  }

  /// Where none are given: of the channel that the normal map reads.
  void addTangents(uint32_t material, Mesh& part) const {
    if (!part.tangents.empty()) return;
    const Material& m = scene_.materials[material];
    const size_t k = m.channel(TextureSlot::normal);
    if (m.normal_texture != kNone) splitMirroredSeams(part, channel(part, k));
    part.tangents = tangentsFromUv(part, channel(part, k));
  }

  /// Whether the primitive has the attribute, as a view of one element a vertex.
  Result<bool> find(const Source& source, const std::string& attribute, AccessorView& view) const {
    const auto entry = source.primitive.attributes.find(attribute);
    if (entry == source.primitive.attributes.end()) return false;
    Result<AccessorView> found = viewAccessor(model_, entry->second);
    if (!found) return found.error();
    view = std::move(*found);
    if (view.count != source.vertex_count) {
      const std::string field = fmt::format("{}.attributes.{}", source.at, attribute);
      return invalid(field, fmt::format("{}", view.count),
                     fmt::format("{} has {} elements for {} vertices", field, view.count, source.vertex_count));
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

  static void append(const Mesh& part, uint32_t material, Mesh& mesh) {
    if (part.indices.empty()) return;
    const size_t base = mesh.positions.size(), total = base + part.positions.size();
    const auto extend = [base, total](auto& array, const auto& with, const auto& otherwise) {
      array.resize(base, otherwise);
      array.insert(array.end(), with.begin(), with.end());
      array.resize(total, otherwise);
    };
    mesh.submeshes.push_back(
        {static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(part.indices.size()), material});
    extend(mesh.positions, part.positions, glm::vec3(0.0f));
    extend(mesh.normals, part.normals, glm::vec3(0.0f));
    extend(mesh.tangents, part.tangents, glm::vec4(0.0f));
    extend(mesh.uvs, part.uvs, glm::vec2(0.0f));
    // What only some parts have, the others get too.
    mesh.more_uvs.resize(std::max(mesh.more_uvs.size(), part.more_uvs.size()));
    for (size_t k = 0; k < mesh.more_uvs.size(); ++k)
      extend(mesh.more_uvs[k], k < part.more_uvs.size() ? part.more_uvs[k] : std::vector<glm::vec2>{}, glm::vec2(0.0f));
    if (!mesh.colors.empty() || !part.colors.empty()) extend(mesh.colors, part.colors, glm::vec4(1.0f));
    if (!mesh.skin.empty() || !part.skin.empty()) extend(mesh.skin, part.skin, VertexSkin{});
    mesh.morph_targets.resize(std::max(mesh.morph_targets.size(), part.morph_targets.size()));
    for (size_t t = 0; t < mesh.morph_targets.size(); ++t) {
      const MorphTarget none, &more = t < part.morph_targets.size() ? part.morph_targets[t] : none;
      extend(mesh.morph_targets[t].positions, more.positions, glm::vec3(0.0f));
      extend(mesh.morph_targets[t].normals, more.normals, glm::vec3(0.0f));
    }
    for (uint32_t index : part.indices) mesh.indices.push_back(static_cast<uint32_t>(base) + index);
  }

  GltfImport& import_;
  const tinygltf::Model& model_;
  const GltfOptions& options_;
  Scene& scene_;
  const std::vector<UvChannels>& channels_of_material_;
  const bool quantized_;
  UniqueNames names_;
  uint64_t triangles_ = 0;
};

}  // namespace

Result<std::vector<uint32_t>> importMeshes(GltfImport& import, const std::vector<UvChannels>& channels_of_material) {
  return MeshImporter(import, channels_of_material).import();
}

}  // namespace helio::scene
