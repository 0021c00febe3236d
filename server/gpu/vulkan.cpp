#define VOLK_IMPLEMENTATION
#define VMA_IMPLEMENTATION
#include "gpu/vulkan.h"

#include <array>
#include <cstdio>

namespace helio::gpu {

const char* name(VkResult result) {
  switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
      return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
      return "out of device memory";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
      return "out of pool memory";
    case VK_ERROR_INITIALIZATION_FAILED:
      return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
      return "device lost";
    case VK_ERROR_LAYER_NOT_PRESENT:
      return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
      return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
      return "feature not present";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
      return "incompatible driver";
    case VK_TIMEOUT:
      return "timeout";
    default:
      return "Vulkan error";
  }
}

void check(VkResult result, const std::string& asked_for) {
  if (result == VK_SUCCESS) return;
  const std::string text = std::string(name(result)) + " (VkResult " + std::to_string(result) + "): " + asked_for;
  if (result == VK_ERROR_DEVICE_LOST)
    throw DeviceLost(
        {ErrorKind::internal, text + "; the driver's log (dmesg) may say why; restart the server", {}, {}, {}});
  const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY ||
                      result == VK_ERROR_OUT_OF_POOL_MEMORY;
  throw Failure({memory ? ErrorKind::limit : ErrorKind::internal, text, {}, {}, {}});
}

std::string bytesInWords(uint64_t bytes) {
  static constexpr std::array units{"B", "KiB", "MiB", "GiB", "TiB"};
  double amount = static_cast<double>(bytes);
  size_t unit = 0;
  for (; amount >= 1024.0 && unit + 1 < units.size(); ++unit) amount /= 1024.0;
  char text[32];
  std::snprintf(text, sizeof text, unit == 0 ? "%.0f %s" : "%.1f %s", amount, units[unit]);
  return text;
}

}  // namespace helio::gpu
