// Vulkan through volk and VMA, and how its failures are told to people.
#pragma once

#include <volk.h>

// VMA takes the entry points that volk loaded.
#define VMA_STATIC_VULKAN_FUNCTIONS 0
#define VMA_DYNAMIC_VULKAN_FUNCTIONS 1
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-variable"
#ifdef __clang__
#pragma clang diagnostic ignored "-Wnullability-completeness"
#endif
#include <vk_mem_alloc.h>
#pragma GCC diagnostic pop

#include <stdexcept>
#include <string>

#include "base/result.h"

namespace helio::gpu {

/// Thrown by everything in gpu/ that cannot go on. `error().kind` is `limit` for out of memory; the faces of render/
/// turn it into a Result. The message names what was asked for.
class Failure : public std::runtime_error {
 public:
  explicit Failure(Error error) : std::runtime_error(error.message), error_(std::move(error)) {}
  const Error& error() const { return error_; }

 private:
  Error error_;
};

/// The device is gone: the process ends (crash-only), its supervisor starts it again.
class DeviceLost : public Failure {
 public:
  using Failure::Failure;
};

const char* name(VkResult result);

/// Throws Failure or DeviceLost unless `result` is VK_SUCCESS. `asked_for`: what the call was for, in words.
void check(VkResult result, const std::string& asked_for);

/// "512.0 MiB"
std::string bytesInWords(uint64_t bytes);

}  // namespace helio::gpu
