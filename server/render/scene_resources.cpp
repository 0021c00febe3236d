#include "render/scene_resources.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <span>
#include <tuple>

#include <glm/gtc/packing.hpp>

#include "scene/levels_of_detail.h"
#include "shared/animation.h"
#include "shared/draw.h"
#include "shared/scene.h"

namespace helio::render {
namespace {

constexpr uint32_t kMaxSubmeshes = 256;  // a geometry index has 8 bits in the visibility image
constexpr size_t kMaxTriangles = size_t{1} << shared::kVisibilityLevelShift;
constexpr uint32_t kMaxInFlightBytes = 64u << 20;
static_assert(shared::kMostLevels > scene::kMostCoarserLevels);

/// Octahedral snorm16 pair [Cigolle et al. 2014].
uint32_t octahedral(const glm::vec3& n) {
  glm::vec3 v = n / (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  if (v.z < 0.0f)
    v = glm::vec3((1.0f - std::abs(v.y)) * (v.x >= 0.0f ? 1.0f : -1.0f),
                  (1.0f - std::abs(v.x)) * (v.y >= 0.0f ? 1.0f : -1.0f), v.z);
  return glm::packSnorm2x16(glm::vec2(v.x, v.y));
}

shared::VertexAttributes attributesOf(const scene::Mesh& mesh, size_t i) {
  const uint32_t handedness = mesh.tangents[i].w >= 0.0f ? 1u : 0u;
  return {octahedral(mesh.normals[i]), (octahedral(glm::vec3(mesh.tangents[i])) & ~1u) | handedness, mesh.uvs[i]};
}

static_assert(shared::kTextureSlots == scene::kTextureSlots);
static_assert(shared::kSlotNormal == static_cast<uint32_t>(scene::TextureSlot::normal));
static_assert(shared::kSlotMetallicRoughness == static_cast<uint32_t>(scene::TextureSlot::metallic_roughness));
static_assert(shared::kSlotSpecular == static_cast<uint32_t>(scene::TextureSlot::specular));
static_assert(shared::kSlotSpecularColor == static_cast<uint32_t>(scene::TextureSlot::specular_color));

VertexOrder vertexOrder(const scene::Mesh& mesh) {
  VertexOrder order{scene::coarsestFirst(mesh), {}};
  order.places.resize(order.vertices.size());
  for (uint32_t place = 0; place < order.vertices.size(); ++place) order.places[order.vertices[place]] = place;
  return order;
}

/// For each vertex the first that lies where it does in every pose. The rasteriser asks for no more than that of what
/// is solid, so corners that differ in their normals alone are worked on once.
std::vector<uint32_t> firstInPlace(const scene::Mesh& mesh, const VertexOrder& order) {
  const auto place = [&mesh](uint32_t i) {
    const glm::vec3& p = mesh.positions[i];
    return std::tie(p.x, p.y, p.z);
  };
  const auto pose = [&mesh](uint32_t i) {
    std::vector<float> values;
    if (!mesh.skin.empty())
      for (int k = 0; k < 4; ++k) {
        values.push_back(mesh.skin[i].joints[k]);
        values.push_back(mesh.skin[i].weights[k]);
      }
    for (const scene::MorphTarget& target : mesh.morph_targets)
      if (!target.positions.empty())
        for (int k = 0; k < 3; ++k) values.push_back(target.positions[i][k]);
    return values;
  };
  const auto before = [&](uint32_t a, uint32_t b) {
    return place(a) != place(b) ? place(a) < place(b) : pose(a) < pose(b);
  };
  std::vector<uint32_t> sorted(mesh.positions.size());  // places in the order of upload
  std::iota(sorted.begin(), sorted.end(), 0u);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](uint32_t a, uint32_t b) { return before(order.vertex(a), order.vertex(b)); });
  std::vector<uint32_t> first(sorted.size());
  for (size_t i = 0; i < sorted.size(); ++i) {
    const bool new_place = i == 0 || before(order.vertex(sorted[i - 1]), order.vertex(sorted[i]));
    first[sorted[i]] = new_place ? sorted[i] : first[sorted[i - 1]];
  }
  return first;
}

/// Slots of the bindless set by index of the scene's textures.
struct TextureSlots {
  const std::vector<uint32_t>& slots;
  uint32_t operator()(uint32_t texture) const { return texture == scene::kNone ? shared::kNoTexture : slots[texture]; }
};

uint32_t flagsOf(const scene::Material& m) {
  uint32_t flags = (m.lambert ? shared::kMaterialLambert : 0) | (m.unlit && !m.lambert ? shared::kMaterialUnlit : 0) |
                   (m.masked() ? shared::kMaterialMasked : 0);
  const glm::vec3& c = m.specular_color;
  if (c.r != c.g || c.g != c.b || m.specular_color_texture != scene::kNone) flags |= shared::kMaterialTintedSpecular;
  for (uint32_t slot = 0; slot < scene::kTextureSlots; ++slot)
    flags |= uint32_t{m.uv_channel[slot]} << (shared::kUvChannelShift + shared::kUvChannelBits * slot);
  return flags;
}

shared::MaterialRecord recordOf(const scene::Material& m, const TextureSlots& slot) {
  shared::MaterialRecord record{};
  record.base_color = m.base_color;
  if (m.masked()) record.base_color.a /= m.alpha_cutoff;
  record.emission = m.emission;
  record.metallic = m.metallic;
  record.roughness = m.roughness;
  record.normal_scale = m.normal_scale;
  record.base_color_texture = slot(m.base_color_texture);
  record.normal_texture = m.lambert ? shared::kNoTexture : slot(m.normal_texture);
  record.metallic_roughness_texture = slot(m.metallic_roughness_texture);
  record.emissive_texture = slot(m.emissive_texture);
  record.flags = flagsOf(m);
  return record;
}

/// f0 = ((ior - 1) / (ior + 1))^2. Schlick's approximation shines at grazing angles whatever f0 is; as the ior goes to
/// 1 the surface must vanish, so below an f0 of 0.02 (no solid or liquid) that fades.
shared::SpecularRecord specularOf(const scene::Material& m, const TextureSlots& slot) {
  const float r = (m.ior - 1.0f) / (m.ior + 1.0f), f0 = r * r;
  return {f0 * m.specular_color, std::min(1.0f, f0 / 0.02f), m.specular, slot(m.specular_texture),
          slot(m.specular_color_texture)};
}

/// The material table, and behind it the records of what reflects otherwise than most.
std::vector<std::byte> materialTable(const scene::Scene& scene, const TextureSlots& slot) {
  std::vector<shared::MaterialRecord> materials;
  std::vector<shared::SpecularRecord> speculars;
  const size_t table_bytes = scene.materials.size() * sizeof(shared::MaterialRecord);
  for (const scene::Material& material : scene.materials) {
    materials.push_back(recordOf(material, slot));
    if (!material.hasOwnSpecular()) continue;
    materials.back().specular = static_cast<uint32_t>(table_bytes + speculars.size() * sizeof(shared::SpecularRecord));
    speculars.push_back(specularOf(material, slot));
  }
  std::vector<std::byte> bytes;
  for (const auto part : {std::as_bytes(std::span(materials)), std::as_bytes(std::span(speculars))})
    bytes.insert(bytes.end(), part.begin(), part.end());
  return bytes;
}

VkSamplerAddressMode addressMode(scene::Wrap wrap) {
  switch (wrap) {
    case scene::Wrap::mirrored_repeat:
      return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
    case scene::Wrap::clamp:
      return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    case scene::Wrap::repeat:
      break;
  }
  return VK_SAMPLER_ADDRESS_MODE_REPEAT;
}

template <typename T>
gpu::Buffer uploaded(gpu::Device& device, gpu::Commands& commands, const std::string& name, const std::vector<T>& items,
                     gpu::MemoryCategory category = gpu::MemoryCategory::raster,
                     VkBufferUsageFlags usage = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR) {
  gpu::Buffer buffer(device, {name, items.size() * sizeof(T), category, gpu::Placement::device, usage});
  commands.upload<T>(buffer, 0, items);
  return buffer;
}

/// Solid submeshes are one geometry where they lie one behind the other: building and refitting a small BLAS costs by
/// geometry more than by triangle (tests/bench/README.md). Where something is cut out, all stay as they are.
void join(std::vector<gpu::BlasGeometry>& geometries) {
  if (geometries.empty()) return;
  VkDeviceAddress next = geometries.front().indices;
  uint32_t triangles = 0;
  for (const gpu::BlasGeometry& geometry : geometries) {
    if (!geometry.opaque || geometry.indices != next) return;
    next += uint64_t{geometry.triangle_count} * 3 * sizeof(uint32_t);
    triangles += geometry.triangle_count;
  }
  geometries.front().triangle_count = triangles;
  geometries.resize(1);
}

}  // namespace

/// What the constructor gathers, mesh by mesh.
struct SceneResources::Tables {
  std::vector<VertexOrder> orders;
  std::vector<size_t> first_vertex, vertex_count;  // by mesh
  std::vector<std::vector<size_t>> first_index;    // by mesh, by level
  std::vector<VkDeviceAddress> extras, deforms;    // by mesh
  std::vector<std::vector<uint32_t>> placed;       // by mesh: firstInPlace()
  std::vector<uint32_t> draw_indices;              // as all indices, but solid triangles of vertices first in place
  effects::EmitterTriangles emitters;

  std::vector<shared::GeometryRecord> geometries;
  std::vector<shared::MeshRecord> meshes;  // by mesh; behind them the coarser levels
  std::vector<shared::DrawRecord> solid, masked;
  std::vector<accel::SharedShape> shapes;  // by entry of `meshes`
};

void SceneResources::addLevel(gpu::Device& device, const scene::Scene& scene, uint32_t m, uint32_t level,
                              Tables& tables) {
  const scene::Mesh& mesh = scene.meshes[m];
  const std::vector<scene::Submesh>& submeshes = level == 0 ? mesh.submeshes : mesh.levels[level - 1].submeshes;
  const std::vector<uint32_t>& indices = level == 0 ? mesh.indices : mesh.levels[level - 1].indices;
  const effects::MeshEmitters& emitters = tables.emitters.meshes[m];
  size_t record = m;
  if (level > 0) {
    record = tables.meshes.size();
    tables.meshes.emplace_back();
    tables.shapes.emplace_back();
    if (level == 1) tables.meshes[m].coarser = static_cast<uint32_t>(record);
  }
  const uint32_t coarser = tables.meshes[record].coarser;
  tables.meshes[record] = {0,
                           static_cast<uint32_t>(tables.geometries.size()),
                           static_cast<uint32_t>(submeshes.size()),
                           emitters.first,
                           emitters.count,
                           coarser,
                           level == 0 ? 0.0f : mesh.levels[level - 1].error};
  // A level's vertices are the mesh's first ones.
  auto vertex_count = static_cast<uint32_t>(mesh.positions.size());
  if (level > 0) {
    vertex_count = 0;
    for (const uint32_t vertex : indices) vertex_count = std::max(vertex_count, tables.orders[m].place(vertex) + 1);
  }
  accel::SharedShape shape{mesh.name, m, {}, indices.size() / 3};
  for (uint32_t g = 0; g < submeshes.size(); ++g) {
    const scene::Submesh& submesh = submeshes[g];
    shared::GeometryRecord geometry{};
    geometry.positions = positions_.address() + tables.first_vertex[m] * sizeof(glm::vec3);
    geometry.attributes = attributes_.address() + tables.first_vertex[m] * sizeof(shared::VertexAttributes);
    const auto first_index = static_cast<uint32_t>(tables.first_index[m][level] + submesh.first_index);
    geometry.indices = indices_.address() + uint64_t{first_index} * sizeof(uint32_t);
    geometry.extras = tables.extras[m];
    geometry.material = submesh.material;
    geometry.emitter_offset = emitters.count ? emitters.geometry_offset[g] : shared::kNoTexture;
    geometry.triangle_count = submesh.index_count / 3;
    tables.geometries.push_back(geometry);
    const bool cut_out = scene.materials[submesh.material].masked() && !submesh.whole;
    shape.geometries.push_back({geometry.positions, vertex_count, geometry.indices, submesh.index_count / 3, !cut_out});
    if (submesh.index_count > 0)
      (cut_out ? tables.masked : tables.solid)
          .push_back({geometry.positions, first_index, submesh.index_count, m, level, g});
    if (cut_out) continue;
    const std::vector<uint32_t>& drawn = tables.placed[m];
    for (uint32_t i = first_index; i < first_index + submesh.index_count; ++i)
      tables.draw_indices[i] = drawn[tables.draw_indices[i]];
  }
  join(shape.geometries);
  if (mesh.deforms()) {  // every instance has a BLAS of its own
    accel::DeformingMesh& deforming = deforming_[m];
    if (level == 0)
      deforming = {tables.deforms[m], positions_.address() + tables.first_vertex[m] * sizeof(glm::vec3), {}};
    deforming.levels.push_back({vertex_count, shape.geometries,
                                gpu::blasSizes(device, shape.geometries, gpu::BlasKind::moving), shape.triangles});
    shape.geometries.clear();
  }
  tables.shapes[record] = std::move(shape);
}

void SceneResources::uploadDraws(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene,
                                 Tables& tables) {
  solid_draws_ = static_cast<uint32_t>(tables.solid.size());
  std::vector<shared::DrawRecord>& draws = tables.solid;
  draws.insert(draws.end(), tables.masked.begin(), tables.masked.end());
  draw_count_ = static_cast<uint32_t>(draws.size());
  draw_records_ = uploaded(device, commands, "the draw table", draws);
  draw_indices_ = uploaded(device, commands, "what is drawn of each triangle", tables.draw_indices,
                           gpu::MemoryCategory::raster, VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
  std::vector<shared::CullMesh> meshes;
  for (const scene::Mesh& mesh : scene.meshes) {
    shared::CullMesh& cull = meshes.emplace_back();
    cull.centre = mesh.bounds.centre();
    cull.radius = 0.5f * glm::length(mesh.bounds.extent());
    cull.level_count = static_cast<uint32_t>(mesh.levels.size() + 1);
    for (size_t l = 0; l < mesh.levels.size(); ++l) cull.errors[l + 1] = mesh.levels[l].error;
  }
  cull_meshes_ = uploaded(device, commands, "meshes to cull", meshes);
}

SceneResources::SceneResources(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene) {
  const std::vector<uint32_t> texture_slots = uploadTextures(device, commands, scene);

  commands.begin();
  // Concatenate the meshes' vertices and indices.
  Tables tables;
  std::vector<glm::vec3> positions;
  std::vector<shared::VertexAttributes> attributes;
  std::vector<uint32_t> indices;
  for (const scene::Mesh& mesh : scene.meshes) {
    if (mesh.submeshes.size() > kMaxSubmeshes)
      throw gpu::Failure({ErrorKind::limit,
                          "the mesh '" + mesh.name + "' has " + std::to_string(mesh.submeshes.size()) +
                              " materials, the limit is " + std::to_string(kMaxSubmeshes) + ": split it",
                          "mesh", mesh.name, std::to_string(kMaxSubmeshes)});
    if (mesh.indices.size() / 3 >= kMaxTriangles)
      throw gpu::Failure({ErrorKind::limit,
                          "the mesh '" + mesh.name + "' has " + std::to_string(mesh.indices.size() / 3) +
                              " triangles, the limit is " + std::to_string(kMaxTriangles) + ": split it",
                          "mesh", mesh.name, std::to_string(kMaxTriangles)});
    const VertexOrder& order = tables.orders.emplace_back(vertexOrder(mesh));
    tables.placed.push_back(firstInPlace(mesh, order));
    tables.first_vertex.push_back(positions.size());
    const auto vertices = static_cast<uint32_t>(mesh.positions.size());
    for (uint32_t i = 0; i < vertices; ++i) {
      positions.push_back(mesh.positions[order.vertex(i)]);
      attributes.push_back(attributesOf(mesh, order.vertex(i)));
    }
    std::vector<size_t>& first_index = tables.first_index.emplace_back();
    const auto append = [&](const std::vector<uint32_t>& level) {
      first_index.push_back(indices.size());
      for (const uint32_t vertex : level) indices.push_back(order.place(vertex));
    };
    append(mesh.indices);
    for (const scene::MeshLevel& level : mesh.levels) append(level.indices);
  }
  positions_ = uploaded(device, commands, "vertex positions", positions);
  attributes_ = uploaded(device, commands, "vertex attributes", attributes);
  indices_ = uploaded(device, commands, "triangle indices", indices);
  tables.draw_indices = std::move(indices);
  tables.extras = uploadExtras(device, commands, scene, tables.orders);
  tables.deforms = uploadDeforms(device, commands, scene, tables.orders);

  // Tables of geometries, and what BLAS builds and draws need of them.
  tables.emitters = effects::collectEmitters(scene);
  tables.meshes.resize(scene.meshes.size());
  tables.shapes.resize(scene.meshes.size());
  deforming_.resize(scene.meshes.size());
  for (uint32_t m = 0; m < scene.meshes.size(); ++m) {
    emitter_power_.push_back(tables.emitters.meshes[m].power);
    for (uint32_t level = 0; level <= scene.meshes[m].levels.size(); ++level) addLevel(device, scene, m, level, tables);
  }
  geometries_ = uploaded(device, commands, "the geometry table", tables.geometries);
  emitter_triangles_ = uploaded(device, commands, "the emissive triangles", tables.emitters.triangles,
                                gpu::MemoryCategory::path_tracing);
  lamp_shapes_ =
      uploaded(device, commands, "the shapes of lamps", tables.emitters.shapes, gpu::MemoryCategory::path_tracing);
  materials_ = uploaded(device, commands, "the material table", materialTable(scene, TextureSlots{texture_slots}));
  uploadDraws(device, commands, scene, tables);

  meshes_ = uploaded(device, commands, "the mesh table", tables.meshes);
  mesh_records_ = std::move(tables.meshes);
  shapes_ = std::move(tables.shapes);
  commands.submit();
  (void)commands.finish();
}

std::vector<VkDeviceAddress> SceneResources::uploadDeforms(gpu::Device& device, gpu::Commands& commands,
                                                           const scene::Scene& scene,
                                                           const std::vector<VertexOrder>& orders) {
  // One buffer: skins, morph targets, then the records that say where they are (in bytes from the buffer's start, plus
  // 1).
  std::vector<std::byte> bytes;
  const auto append = [&bytes](auto span) {
    bytes.resize(gpu::alignUp(bytes.size(), size_t{16}));
    const uint64_t at = bytes.size();
    const auto raw = std::as_bytes(span);
    bytes.insert(bytes.end(), raw.begin(), raw.end());
    return at + 1;
  };
  std::vector<shared::MeshDeform> records;
  std::vector<size_t> record_of_mesh(scene.meshes.size(), scene::kNone);
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    if (!mesh.deforms()) continue;
    shared::MeshDeform record{};
    record.vertex_count = static_cast<uint32_t>(mesh.positions.size());
    record.fit_height = mesh.fit_height;
    if (!mesh.skin.empty()) {
      std::vector<shared::VertexSkinRecord> skin;
      for (uint32_t i = 0; i < mesh.skin.size(); ++i) {
        const scene::VertexSkin& v = mesh.skin[orders[m].vertex(i)];
        skin.push_back({v.joints.x | uint32_t{v.joints.y} << 16, v.joints.z | uint32_t{v.joints.w} << 16,
                        glm::packUnorm2x16(glm::vec2(v.weights)),
                        glm::packUnorm2x16(glm::vec2(v.weights.z, v.weights.w))});
      }
      record.skin = append(std::span<const shared::VertexSkinRecord>(skin));
    }
    record.morph_count = static_cast<uint32_t>(mesh.morph_targets.size());
    std::vector<glm::vec3> morphs;
    for (const scene::MorphTarget& target : mesh.morph_targets)
      for (const std::vector<glm::vec3>* values : {&target.positions, &target.normals})
        for (uint32_t i = 0; i < values->size(); ++i) morphs.push_back((*values)[orders[m].vertex(i)]);
    if (!morphs.empty()) record.morphs = append(std::span<const glm::vec3>(morphs));
    record_of_mesh[m] = records.size();
    records.push_back(record);
  }
  std::vector<VkDeviceAddress> addresses(scene.meshes.size(), 0);
  if (records.empty()) return addresses;
  const uint64_t records_at = gpu::alignUp(bytes.size(), size_t{16});
  deforms_ = gpu::Buffer(device, {"skins and morph targets", records_at + records.size() * sizeof(shared::MeshDeform),
                                  gpu::MemoryCategory::raster});
  for (shared::MeshDeform& record : records)
    for (uint64_t* table : {&record.skin, &record.morphs})
      if (*table != 0) *table += deforms_.address() - 1;
  if (!bytes.empty()) commands.upload(deforms_, 0, bytes);
  commands.upload(deforms_, records_at, std::as_bytes(std::span(records)));
  for (size_t m = 0; m < addresses.size(); ++m)
    if (record_of_mesh[m] != scene::kNone)
      addresses[m] = deforms_.address() + records_at + record_of_mesh[m] * sizeof(shared::MeshDeform);
  return addresses;
}

std::vector<VkDeviceAddress> SceneResources::uploadExtras(gpu::Device& device, gpu::Commands& commands,
                                                          const scene::Scene& scene,
                                                          const std::vector<VertexOrder>& orders) {
  // One buffer: every mesh's arrays one behind the other, then the tables that say where they are.
  std::vector<glm::uvec2> words;
  std::vector<shared::VertexExtras> tables;  // in words from the buffer's start, plus 1
  std::vector<size_t> table_of_mesh;         // kNone: none
  const auto append = [&words](const VertexOrder& order, const auto& array, auto&& pack) {
    const uint64_t first = words.size() + 1;
    for (uint32_t i = 0; i < array.size(); ++i) words.push_back(pack(array[order.vertex(i)]));
    return first;
  };
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const scene::Mesh& mesh = scene.meshes[m];
    table_of_mesh.push_back(mesh.colors.empty() && mesh.more_uvs.empty() ? scene::kNone : tables.size());
    if (table_of_mesh.back() == scene::kNone) continue;
    shared::VertexExtras table{};
    if (!mesh.colors.empty()) {
      table.colors = append(orders[m], mesh.colors, [](const glm::vec4& c) {
        return glm::uvec2(glm::packUnorm2x16(glm::vec2(c)), glm::packUnorm2x16(glm::vec2(c.z, c.w)));
      });
    }
    for (size_t k = 0; k < std::min(mesh.more_uvs.size(), std::size(table.uvs)); ++k)
      table.uvs[k] = append(orders[m], mesh.more_uvs[k], [](const glm::vec2& uv) { return glm::floatBitsToUint(uv); });
    tables.push_back(table);
  }
  std::vector<VkDeviceAddress> addresses(scene.meshes.size(), 0);
  if (tables.empty()) return addresses;

  const uint64_t array_bytes = words.size() * sizeof(glm::uvec2);
  extras_ = gpu::Buffer(device, {"vertex extras", array_bytes + tables.size() * sizeof(shared::VertexExtras),
                                 gpu::MemoryCategory::raster});
  const auto toAddress = [this](uint64_t& word) {
    if (word != 0) word = extras_.address() + (word - 1) * sizeof(glm::uvec2);
  };
  for (shared::VertexExtras& table : tables) {
    toAddress(table.colors);
    for (uint64_t& uvs : table.uvs) toAddress(uvs);
  }
  commands.upload<glm::uvec2>(extras_, 0, words);
  commands.upload(extras_, array_bytes, std::as_bytes(std::span(tables)));
  for (size_t m = 0; m < addresses.size(); ++m) {
    if (table_of_mesh[m] != scene::kNone)
      addresses[m] = extras_.address() + array_bytes + table_of_mesh[m] * sizeof(shared::VertexExtras);
  }
  return addresses;
}

std::vector<uint32_t> SceneResources::uploadTextures(gpu::Device& device, gpu::Commands& commands,
                                                     const scene::Scene& scene) {
  std::vector<uint32_t> slots;
  uint64_t in_flight = 0;
  commands.begin();
  for (const scene::Texture& texture : scene.textures) {
    // Staging memory holds a few textures at a time.
    if (in_flight > kMaxInFlightBytes) {
      commands.submit();
      (void)commands.finish();
      commands.begin();
      in_flight = 0;
    }
    const auto mips = static_cast<uint32_t>(std::bit_width(std::max(texture.width, texture.height)));
    textures_.emplace_back(
        device, gpu::ImageDescription{
                    "the texture " + texture.name,
                    texture.width,
                    texture.height,
                    mips,
                    texture.srgb ? VK_FORMAT_R8G8B8A8_SRGB : VK_FORMAT_R8G8B8A8_UNORM,
                    VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                    gpu::MemoryCategory::raster,
                    {texture.sampling.nearest, addressMode(texture.sampling.u), addressMode(texture.sampling.v)}});
    commands.uploadTexture(textures_.back(), std::as_bytes(std::span(texture.rgba)));
    slots.push_back(textures_.back().slot());
    in_flight += texture.rgba.size();
    texture_bytes_ += texture.rgba.size() * 4 / 3;
  }
  commands.submit();
  (void)commands.finish();
  return slots;
}

}  // namespace helio::render
