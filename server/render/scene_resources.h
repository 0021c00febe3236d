// A scene on the GPU: vertices, textures, materials, geometry and mesh tables, one shared BLAS a mesh, emissive
// triangles. Immutable after upload; what users change is in accel::InstanceTable.
#pragma once

#include <vector>

#include "accel/units.h"
#include "effects/emitters.h"
#include "gpu/acceleration_structure.h"
#include "scene/scene.h"

namespace helio::render {

/// Where the raster side finds the triangles of one submesh.
struct DrawGeometry {
  VkDeviceAddress positions;
  VkDeviceAddress indices;
  uint32_t index_count;
  bool cut_out;  ///< the fragment shader asks the material's mask
};

class SceneResources {
 public:
  /// Uploads and builds; waits for the GPU. Throws gpu::Failure when memory runs out or a limit of the tables is
  /// passed.
  SceneResources(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  VkDeviceAddress meshes() const { return meshes_.address(); }
  VkDeviceAddress geometries() const { return geometries_.address(); }
  VkDeviceAddress materials() const { return materials_.address(); }
  VkDeviceAddress emitterTriangles() const { return emitter_triangles_.address(); }
  uint64_t emitterBytes() const { return emitter_triangles_.size(); }
  uint64_t textureBytes() const { return texture_bytes_; }
  uint64_t blasBytes() const;  ///< of the shared BLASes
  /// By mesh: what its instances' own BLASes are made of; empty entries for rigid meshes.
  const std::vector<accel::DeformingMesh>& deforming() const { return deforming_; }
  const std::vector<float>& emitterPower() const { return emitter_power_; }       ///< by mesh
  const std::vector<std::vector<DrawGeometry>>& draws() const { return draws_; }  ///< by mesh, by submesh

 private:
  std::vector<uint32_t> uploadTextures(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  /// Where each mesh's VertexExtras are; 0: it has none.
  std::vector<VkDeviceAddress> uploadExtras(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  /// Skins and morph targets, and where each deforming mesh has its own.
  std::vector<VkDeviceAddress> uploadDeforms(gpu::Device& device, gpu::Commands& commands, const scene::Scene& scene);

  std::vector<gpu::Image> textures_;
  uint64_t texture_bytes_ = 0;
  gpu::Buffer positions_, attributes_, indices_, extras_, deforms_;
  gpu::Buffer meshes_, geometries_, materials_, emitter_triangles_;
  std::vector<gpu::AccelerationStructure> blases_;
  std::vector<accel::DeformingMesh> deforming_;
  std::vector<float> emitter_power_;
  std::vector<std::vector<DrawGeometry>> draws_;
};

}  // namespace helio::render
