#include "gpu/acceleration_structure.h"

namespace helio::gpu {
namespace {

VkAccelerationStructureBuildSizesInfoKHR sizes(Device& device, const VkAccelerationStructureBuildGeometryInfoKHR& build,
                                               const uint32_t* counts) {
  VkAccelerationStructureBuildSizesInfoKHR result{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
  vkGetAccelerationStructureBuildSizesKHR(device.handle(), VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &build,
                                          counts, &result);
  return result;
}

VkAccelerationStructureGeometryKHR triangles(const BlasGeometry& input) {
  VkAccelerationStructureGeometryKHR geometry{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
  geometry.geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR;
  geometry.flags = input.opaque ? VK_GEOMETRY_OPAQUE_BIT_KHR : 0;
  auto& data = geometry.geometry.triangles;
  data = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR};
  data.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
  data.vertexData.deviceAddress = input.positions;
  data.vertexStride = 12;
  data.maxVertex = input.vertex_count - 1;
  data.indexType = VK_INDEX_TYPE_UINT32;
  data.indexData.deviceAddress = input.indices;
  return geometry;
}

}  // namespace

AccelerationStructure::AccelerationStructure(Device& device, const std::string& name,
                                             VkAccelerationStructureTypeKHR type, uint64_t size)
    : device_(&device),
      buffer_(device, {name, size, MemoryCategory::ray_tracing, Placement::device,
                       VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR}) {
  create(name, type, buffer_.handle(), 0, size);
}

AccelerationStructure::AccelerationStructure(Device& device, const std::string& name,
                                             VkAccelerationStructureTypeKHR type, const Range& range)
    : device_(&device) {
  create(name, type, range.buffer, range.offset, range.size);
}

void AccelerationStructure::create(const std::string& name, VkAccelerationStructureTypeKHR type, VkBuffer buffer,
                                   uint64_t offset, uint64_t size) {
  VkAccelerationStructureCreateInfoKHR info{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR};
  info.buffer = buffer;
  info.offset = offset;
  info.size = size;
  info.type = type;
  check(vkCreateAccelerationStructureKHR(device_->handle(), &info, nullptr, &handle_),
        "the acceleration structure " + name);
  VkAccelerationStructureDeviceAddressInfoKHR address{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR};
  address.accelerationStructure = handle_;
  address_ = vkGetAccelerationStructureDeviceAddressKHR(device_->handle(), &address);
}

AccelerationStructure::~AccelerationStructure() {
  if (handle_) vkDestroyAccelerationStructureKHR(device_->handle(), handle_, nullptr);
}

void AccelerationStructure::swap(AccelerationStructure& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(handle_, other.handle_);
  std::swap(address_, other.address_);
}

namespace {

VkAccelerationStructureBuildGeometryInfoKHR blasBuild(const std::vector<VkAccelerationStructureGeometryKHR>& geometries,
                                                      BlasKind kind) {
  VkAccelerationStructureBuildGeometryInfoKHR build{VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
  build.type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR;
  build.flags = kind == BlasKind::still ? VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR |
                                              VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_COMPACTION_BIT_KHR
                                        : VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_BUILD_BIT_KHR |
                                              VK_BUILD_ACCELERATION_STRUCTURE_ALLOW_UPDATE_BIT_KHR;
  build.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  build.geometryCount = static_cast<uint32_t>(geometries.size());
  build.pGeometries = geometries.data();
  return build;
}

}  // namespace

BlasSizes blasSizes(Device& device, std::span<const BlasGeometry> inputs, BlasKind kind) {
  std::vector<VkAccelerationStructureGeometryKHR> geometries;
  std::vector<uint32_t> counts;
  for (const BlasGeometry& input : inputs) {
    geometries.push_back(triangles(input));
    counts.push_back(input.triangle_count);
  }
  const auto size = sizes(device, blasBuild(geometries, kind), counts.data());
  return {size.accelerationStructureSize, size.buildScratchSize, size.updateScratchSize};
}

uint64_t scratchFor(Device& device, std::span<const uint64_t> scratch_sizes) {
  uint64_t scratch = 0;
  for (const uint64_t size : scratch_sizes) scratch = alignUp(scratch + size, device.scratchAlignment());
  return scratch;
}

void updateBlases(Commands& commands, std::span<const BlasUpdate> updates, std::span<const uint64_t> scratch_sizes,
                  const Buffer& scratch, bool one_call) {
  std::vector<std::vector<VkAccelerationStructureGeometryKHR>> geometries(updates.size());
  std::vector<std::vector<VkAccelerationStructureBuildRangeInfoKHR>> ranges(updates.size());
  std::vector<VkAccelerationStructureBuildGeometryInfoKHR> builds;
  std::vector<const VkAccelerationStructureBuildRangeInfoKHR*> range_pointers;
  uint64_t offset = 0;
  for (size_t i = 0; i < updates.size(); ++i) {
    for (const BlasGeometry& input : updates[i].geometries) {
      geometries[i].push_back(triangles(input));
      ranges[i].push_back({input.triangle_count, 0, 0, 0});
    }
    VkAccelerationStructureBuildGeometryInfoKHR build = blasBuild(geometries[i], updates[i].kind);
    if (updates[i].refit) build.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_UPDATE_KHR;
    build.srcAccelerationStructure = updates[i].refit ? updates[i].structure : VK_NULL_HANDLE;
    build.dstAccelerationStructure = updates[i].structure;
    build.scratchData.deviceAddress = scratch.address() + offset;
    offset = alignUp(offset + scratch_sizes[i], commands.device().scratchAlignment());
    builds.push_back(build);
    range_pointers.push_back(ranges[i].data());
  }
  if (one_call) {
    if (!builds.empty())
      vkCmdBuildAccelerationStructuresKHR(commands.handle(), static_cast<uint32_t>(builds.size()), builds.data(),
                                          range_pointers.data());
    return;
  }
  for (size_t i = 0; i < builds.size(); ++i) {
    vkCmdBuildAccelerationStructuresKHR(commands.handle(), 1, &builds[i], &range_pointers[i]);
    commands.barrier(use::build_write, use::build_write);
  }
}

std::vector<AccelerationStructure> buildBlases(Commands& commands, std::span<const BlasInput> inputs) {
  Device& device = commands.device();
  std::vector<AccelerationStructure> structures;
  if (inputs.empty()) return structures;
  std::vector<BlasUpdate> updates;
  std::vector<uint64_t> scratch_sizes;
  for (const BlasInput& input : inputs) {
    const BlasSizes size = blasSizes(device, input.geometries, BlasKind::still);
    structures.emplace_back(device, "the BLAS of " + input.name, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR,
                            size.structure);
    updates.push_back({structures.back().handle(), input.geometries, BlasKind::still});
    scratch_sizes.push_back(size.build_scratch);
  }
  Buffer scratch(device, {"the scratch memory of " + std::to_string(inputs.size()) + " BLAS builds",
                          scratchFor(device, scratch_sizes), MemoryCategory::ray_tracing});
  updateBlases(commands, updates, scratch_sizes, scratch);
  commands.retire(std::move(scratch));
  return structures;
}

void buildTlases(Commands& commands, std::span<const TlasInput> inputs) {
  Device& device = commands.device();
  std::vector<VkAccelerationStructureGeometryKHR> geometries(inputs.size());
  std::vector<VkAccelerationStructureBuildGeometryInfoKHR> builds(inputs.size());
  std::vector<VkAccelerationStructureBuildRangeInfoKHR> ranges(inputs.size());
  std::vector<const VkAccelerationStructureBuildRangeInfoKHR*> range_of(inputs.size());
  for (size_t i = 0; i < inputs.size(); ++i) {
    const TlasInput& input = inputs[i];
    VkAccelerationStructureGeometryKHR& geometry = geometries[i];
    geometry = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR};
    geometry.geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR;
    geometry.geometry.instances = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR};
    geometry.geometry.instances.data.deviceAddress = input.instances;
    VkAccelerationStructureBuildGeometryInfoKHR& build = builds[i];
    build = {VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR};
    build.type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR;
    // It is built in every tick that changes something; on the H200 it even traces as fast (tests/bench/README.md).
    build.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_BUILD_BIT_KHR;
    build.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
    build.geometryCount = 1;
    build.pGeometries = &geometry;
    Tlas& tlas = *input.tlas;
    if (!tlas.structure_ || input.count != tlas.capacity_) {
      const auto size = sizes(device, build, &input.count);
      AccelerationStructure structure(device, "the TLAS", VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR,
                                      size.accelerationStructureSize);
      tlas.scratch_ =
          Buffer(device, {"the scratch memory of the TLAS", size.buildScratchSize, MemoryCategory::ray_tracing});
      tlas.structure_ = std::move(structure);
      tlas.capacity_ = input.count;
    }
    build.dstAccelerationStructure = tlas.structure_.handle();
    build.scratchData.deviceAddress = tlas.scratch_.address();
    ranges[i] = {input.count, 0, 0, 0};
    range_of[i] = &ranges[i];
  }
  vkCmdBuildAccelerationStructuresKHR(commands.handle(), static_cast<uint32_t>(builds.size()), builds.data(),
                                      range_of.data());
}

}  // namespace helio::gpu
