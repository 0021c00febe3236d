// The Vulkan features that the renderer needs: one list is what is enabled and what a device is asked for by name.
#pragma once

#include <string>

#include "gpu/vulkan.h"

namespace helio::gpu {

/// The structures of features, chained; all off.
class Features {
 public:
  Features();
  Features(const Features&) = delete;  // the chain points into it
  Features& operator=(const Features&) = delete;

  void requireAll();
  /// Those of them that `device`, of Vulkan 1.3 and with ray tracing pipelines, does not have: names with commas
  /// between them; empty: none.
  static std::string missing(VkPhysicalDevice device);
  /// The required ones that are off here.
  std::string off();
  /// For vkCreateDevice().
  const VkPhysicalDeviceFeatures2& chain() const { return features_; }

 private:
  struct Required;

  VkPhysicalDeviceRayTracingPipelineFeaturesKHR ray_tracing_{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_FEATURES_KHR};
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures_{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR};
  VkPhysicalDeviceVulkan13Features vulkan13_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features vulkan12_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceVulkan11Features vulkan11_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
  VkPhysicalDeviceFeatures2 features_{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
};

}  // namespace helio::gpu
