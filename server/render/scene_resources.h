// A scene on the GPU: vertices, textures, materials, geometry and mesh tables, emissive triangles. Immutable after
// upload; what users change is in accel::InstanceTable, and BLASes come and go in accel::SharedBlases.
#pragma once

#include <vector>

#include "accel/shared_blases.h"
#include "accel/units.h"
#include "effects/emitters.h"
#include "scene/scene.h"

namespace helio::render {

/// A mesh's vertices as they are uploaded: those of coarse levels of detail first (scene/levels_of_detail.h).
struct VertexOrder {
  std::vector<uint32_t> vertices;  ///< of the mesh, in this order; empty: as they are
  std::vector<uint32_t> places;    ///< of each of them in `vertices`
  uint32_t vertex(uint32_t place) const { return vertices.empty() ? place : vertices[place]; }
  uint32_t place(uint32_t vertex) const { return places.empty() ? vertex : places[vertex]; }
};

class SceneResources {
 public:
  /// Uploads; waits for the GPU. Throws gpu::Failure when memory runs out or a limit of the tables is
  /// passed.
  SceneResources(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  VkDeviceAddress meshes() const { return meshes_.address(); }
  VkDeviceAddress geometries() const { return geometries_.address(); }
  VkDeviceAddress materials() const { return materials_.address(); }
  VkDeviceAddress emitterTriangles() const { return emitter_triangles_.address(); }
  VkDeviceAddress lampShapes() const { return lamp_shapes_.address(); }
  uint64_t emitterBytes() const { return emitter_triangles_.size() + lamp_shapes_.size(); }
  uint64_t textureBytes() const { return texture_bytes_; }
  /// The mesh table, and by record what its BLAS is built of.
  const std::vector<shared::MeshRecord>& meshRecords() const { return mesh_records_; }
  const std::vector<accel::SharedShape>& shapes() const { return shapes_; }
  /// By mesh: what its instances' own BLASes are made of; empty entries for rigid meshes.
  const std::vector<accel::DeformingMesh>& deforming() const { return deforming_; }
  const std::vector<float>& emitterPower() const { return emitter_power_; }  ///< by mesh
  // For the rasteriser (shared/draw.h): a DrawRecord for each submesh and level, those that ask no mask first; and a
  // CullMesh a mesh.
  VkDeviceAddress drawRecords() const { return draw_records_.address(); }
  const gpu::Buffer& drawIndices() const { return draw_indices_; }
  uint32_t drawCount() const { return draw_count_; }
  uint32_t solidDraws() const { return solid_draws_; }
  VkDeviceAddress cullMeshes() const { return cull_meshes_.address(); }

 private:
  struct Tables;  // while they are filled
  /// Adds the records of one mesh at one of its levels; level 0 first.
  void addLevel(gpu::Device& device, const scene::Scene& scene, uint32_t mesh, uint32_t level, Tables& tables);
  void uploadDraws(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene, Tables& tables);

  std::vector<uint32_t> uploadTextures(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  /// Where each mesh's VertexExtras are; 0: it has none.
  std::vector<VkDeviceAddress> uploadExtras(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene,
                                            const std::vector<VertexOrder>& orders);

  /// Skins and morph targets, and where each deforming mesh has its own.
  std::vector<VkDeviceAddress> uploadDeforms(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene,
                                             const std::vector<VertexOrder>& orders);

  std::vector<gpu::Image> textures_;
  uint64_t texture_bytes_ = 0;
  gpu::Buffer positions_, attributes_, indices_, extras_, deforms_;
  gpu::Buffer meshes_, geometries_, materials_, emitter_triangles_, lamp_shapes_;
  gpu::Buffer draw_records_, draw_indices_, cull_meshes_;
  uint32_t draw_count_ = 0, solid_draws_ = 0;
  std::vector<shared::MeshRecord> mesh_records_;
  std::vector<accel::SharedShape> shapes_;
  std::vector<accel::DeformingMesh> deforming_;
  std::vector<float> emitter_power_;
};

}  // namespace helio::render
