#include "gpu/features.h"

namespace helio::gpu {

struct Features::Required {
  const char* name;
  VkBool32& (*in)(Features& features);

  static const Required kAll[];
};

// The name that people read is the field's.
#define HELIO_REQUIRED(structure, field)                                \
  {                                                                     \
#field, [](Features & f) -> VkBool32& { return f.structure.field; } \
  }
const Features::Required Features::Required::kAll[] = {
    HELIO_REQUIRED(ray_tracing_, rayTracingPipeline),
    HELIO_REQUIRED(ray_tracing_, rayTracingPipelineTraceRaysIndirect),
    HELIO_REQUIRED(structures_, accelerationStructure),
    HELIO_REQUIRED(vulkan13_, synchronization2),
    HELIO_REQUIRED(vulkan13_, dynamicRendering),
    HELIO_REQUIRED(vulkan13_, maintenance4),
    HELIO_REQUIRED(vulkan12_, bufferDeviceAddress),
    HELIO_REQUIRED(vulkan12_, drawIndirectCount),
    HELIO_REQUIRED(vulkan12_, timelineSemaphore),
    HELIO_REQUIRED(vulkan12_, hostQueryReset),
    HELIO_REQUIRED(vulkan12_, scalarBlockLayout),
    HELIO_REQUIRED(vulkan12_, shaderBufferInt64Atomics),
    HELIO_REQUIRED(vulkan12_, descriptorIndexing),
    HELIO_REQUIRED(vulkan12_, runtimeDescriptorArray),
    HELIO_REQUIRED(vulkan12_, descriptorBindingPartiallyBound),
    HELIO_REQUIRED(vulkan12_, descriptorBindingUpdateUnusedWhilePending),
    HELIO_REQUIRED(vulkan12_, descriptorBindingSampledImageUpdateAfterBind),
    HELIO_REQUIRED(vulkan12_, descriptorBindingStorageImageUpdateAfterBind),
    HELIO_REQUIRED(vulkan12_, shaderSampledImageArrayNonUniformIndexing),
    HELIO_REQUIRED(vulkan11_, shaderDrawParameters),
    HELIO_REQUIRED(features_.features, shaderInt64),
    HELIO_REQUIRED(features_.features, multiDrawIndirect),
    HELIO_REQUIRED(features_.features, drawIndirectFirstInstance),
    HELIO_REQUIRED(features_.features, geometryShader),  // gl_PrimitiveID in fragment shaders
    HELIO_REQUIRED(features_.features, samplerAnisotropy),
    HELIO_REQUIRED(features_.features, shaderStorageImageExtendedFormats),  // rg32ui
};
#undef HELIO_REQUIRED

Features::Features() {
  features_.pNext = &vulkan11_;
  vulkan11_.pNext = &vulkan12_;
  vulkan12_.pNext = &vulkan13_;
  vulkan13_.pNext = &structures_;
  structures_.pNext = &ray_tracing_;
}

void Features::requireAll() {
  for (const Required& required : Required::kAll) required.in(*this) = VK_TRUE;
}

std::string Features::off() {
  std::string names;
  for (const Required& required : Required::kAll)
    if (required.in(*this) != VK_TRUE) names += (names.empty() ? "" : ", ") + std::string(required.name);
  return names;
}

std::string Features::missing(VkPhysicalDevice device) {
  Features offered;
  vkGetPhysicalDeviceFeatures2(device, &offered.features_);
  return offered.off();
}

}  // namespace helio::gpu
