#include "gpu/pipelines.h"

#include <array>
#include <cstring>

#include "embedded.h"

namespace helio::gpu {
namespace {

/// A shader module that lives as long as the pipeline's creation.
class Module {
 public:
  Module(Device& device, const std::string& shader) : Module(device, shader, shaders::find(shader)) {}
  Module(Device& device, const std::string& shader, std::span<const uint32_t> words) : device_(device) {
    if (words.empty()) throw Failure({ErrorKind::internal, "no shader '" + shader + "' in this build", {}, {}, {}});
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = words.size_bytes();
    info.pCode = words.data();
    check(vkCreateShaderModule(device.handle(), &info, nullptr, &handle_), "the shader " + shader);
  }
  Module(Module&& other) noexcept : device_(other.device_) { std::swap(handle_, other.handle_); }
  ~Module() {
    if (handle_) vkDestroyShaderModule(device_.handle(), handle_, nullptr);
  }
  VkShaderModule handle() const { return handle_; }

 private:
  Device& device_;
  VkShaderModule handle_ = VK_NULL_HANDLE;
};

/// VkSpecializationInfo of constants 0, 1, 2, ...
struct Constants {
  explicit Constants(const Specialisation& values) {
    for (uint32_t i = 0; i < values.size(); ++i)
      entries.push_back({i, static_cast<uint32_t>(i * sizeof(uint32_t)), sizeof(uint32_t)});
    info = {static_cast<uint32_t>(entries.size()), entries.data(), values.size() * sizeof(uint32_t), values.data()};
  }
  Constants(const Constants&) = delete;
  std::vector<VkSpecializationMapEntry> entries;
  VkSpecializationInfo info{};
};

VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits bit, const Module& module, const Constants& constants) {
  VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
  info.stage = bit;
  info.module = module.handle();
  info.pName = "main";
  info.pSpecializationInfo = &constants.info;
  return info;
}

}  // namespace

Pipeline::~Pipeline() {
  if (handle_) vkDestroyPipeline(device_->handle(), handle_, nullptr);
}

ComputePipeline::ComputePipeline(Device& device, const std::string& shader, const Specialisation& values)
    : ComputePipeline(device, shader, shaders::find(shader), values) {}

ComputePipeline::ComputePipeline(Device& device, const std::string& name, std::span<const uint32_t> words,
                                 const Specialisation& values) {
  device_ = &device;
  const Module module(device, name, words);
  const Constants constants(values);
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage = stage(VK_SHADER_STAGE_COMPUTE_BIT, module, constants);
  info.layout = device.pipelineLayout();
  check(vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &handle_), "the pipeline " + name);
}

RasterPipeline::RasterPipeline(Device& device, const RasterDescription& description) {
  device_ = &device;
  const Module vertex(device, description.vertex);
  const Module fragment(device, description.fragment);
  const Constants constants(description.constants);
  const std::array stages{stage(VK_SHADER_STAGE_VERTEX_BIT, vertex, constants),
                          stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, constants)};

  const VkPipelineVertexInputStateCreateInfo no_vertex_buffers{
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = VK_CULL_MODE_NONE;  // rays hit both faces, so the raster side draws both
  raster.lineWidth = 1.0f;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = VK_COMPARE_OP_GREATER;
  std::vector<VkPipelineColorBlendAttachmentState> attachments(description.colors.size());
  for (auto& a : attachments) a.colorWriteMask = 0xf;
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = static_cast<uint32_t>(attachments.size());
  blend.pAttachments = attachments.data();
  const std::array dynamic{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamics{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamics.dynamicStateCount = static_cast<uint32_t>(dynamic.size());
  dynamics.pDynamicStates = dynamic.data();
  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = static_cast<uint32_t>(description.colors.size());
  rendering.pColorAttachmentFormats = description.colors.data();
  rendering.depthAttachmentFormat = description.depth;

  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.pNext = &rendering;
  info.stageCount = static_cast<uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &no_vertex_buffers;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamics;
  info.layout = device.pipelineLayout();
  check(vkCreateGraphicsPipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &handle_),
        "the pipeline " + description.vertex);
}

RayTracingPipeline::RayTracingPipeline(Device& device, const RayTracingDescription& description) {
  device_ = &device;
  const Constants constants(description.constants);
  std::vector<Module> modules;
  std::vector<VkPipelineShaderStageCreateInfo> stages;
  std::vector<VkRayTracingShaderGroupCreateInfoKHR> groups;
  modules.reserve(1 + description.misses.size() + 2 * description.hits.size());
  const auto add_stage = [&](VkShaderStageFlagBits bit, const std::string& shader) {
    modules.emplace_back(device, shader);
    stages.push_back(stage(bit, modules.back(), constants));
    return static_cast<uint32_t>(stages.size() - 1);
  };
  const auto add_group = [&](VkRayTracingShaderGroupTypeKHR type, uint32_t general, uint32_t closest, uint32_t any) {
    VkRayTracingShaderGroupCreateInfoKHR group{VK_STRUCTURE_TYPE_RAY_TRACING_SHADER_GROUP_CREATE_INFO_KHR};
    group.type = type;
    group.generalShader = general;
    group.closestHitShader = closest;
    group.anyHitShader = any;
    group.intersectionShader = VK_SHADER_UNUSED_KHR;
    groups.push_back(group);
  };
  constexpr uint32_t kUnused = VK_SHADER_UNUSED_KHR;
  add_group(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR, add_stage(VK_SHADER_STAGE_RAYGEN_BIT_KHR, description.raygen),
            kUnused, kUnused);
  for (const std::string& miss : description.misses)
    add_group(VK_RAY_TRACING_SHADER_GROUP_TYPE_GENERAL_KHR, add_stage(VK_SHADER_STAGE_MISS_BIT_KHR, miss), kUnused,
              kUnused);
  for (const HitGroup& hit : description.hits) {
    const uint32_t closest =
        hit.closest_hit.empty() ? kUnused : add_stage(VK_SHADER_STAGE_CLOSEST_HIT_BIT_KHR, hit.closest_hit);
    const uint32_t any = hit.any_hit.empty() ? kUnused : add_stage(VK_SHADER_STAGE_ANY_HIT_BIT_KHR, hit.any_hit);
    add_group(VK_RAY_TRACING_SHADER_GROUP_TYPE_TRIANGLES_HIT_GROUP_KHR, kUnused, closest, any);
  }
  VkRayTracingPipelineCreateInfoKHR info{VK_STRUCTURE_TYPE_RAY_TRACING_PIPELINE_CREATE_INFO_KHR};
  info.stageCount = static_cast<uint32_t>(stages.size());
  info.pStages = stages.data();
  info.groupCount = static_cast<uint32_t>(groups.size());
  info.pGroups = groups.data();
  info.maxPipelineRayRecursionDepth = 1;
  info.layout = device.pipelineLayout();
  check(vkCreateRayTracingPipelinesKHR(device.handle(), VK_NULL_HANDLE, VK_NULL_HANDLE, 1, &info, nullptr, &handle_),
        "the pipeline " + description.raygen);

  // Lay out the shader table: raygen | misses | hits, each region at the base alignment, each record at the handle's.
  const auto& limits = device.rayTracing();
  const uint32_t handle_size = limits.shaderGroupHandleSize;
  const uint32_t record = alignUp(handle_size, limits.shaderGroupHandleAlignment);
  const uint32_t base = limits.shaderGroupBaseAlignment;
  const auto misses = static_cast<uint32_t>(description.misses.size());
  const auto hits = static_cast<uint32_t>(description.hits.size());
  const uint32_t miss_offset = alignUp(record, base);
  const uint32_t hit_offset = miss_offset + alignUp(misses * record, base);
  std::vector<std::byte> handles(groups.size() * handle_size);
  check(vkGetRayTracingShaderGroupHandlesKHR(device.handle(), handle_, 0, static_cast<uint32_t>(groups.size()),
                                             handles.size(), handles.data()),
        "the shader table of " + description.raygen);
  table_ =
      Buffer(device, {"the shader table of " + description.raygen, hit_offset + alignUp(hits * record, base),
                      MemoryCategory::ray_tracing, Placement::upload, VK_BUFFER_USAGE_SHADER_BINDING_TABLE_BIT_KHR});
  const auto write = [&](uint32_t offset, uint32_t group) {
    std::memcpy(table_.mapped() + offset, handles.data() + group * handle_size, handle_size);
  };
  write(0, 0);
  for (uint32_t i = 0; i < misses; ++i) write(miss_offset + i * record, 1 + i);
  for (uint32_t i = 0; i < hits; ++i) write(hit_offset + i * record, 1 + misses + i);
  const uint32_t raygen_size = alignUp(record, base);  // Vulkan wants size == stride here
  raygen_ = {table_.address(), raygen_size, raygen_size};
  miss_ = {table_.address() + miss_offset, record, misses * record};
  hit_ = {table_.address() + hit_offset, record, hits * record};
}

}  // namespace helio::gpu
