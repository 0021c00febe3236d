#include "gpu/device.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <cstring>

#include "gpu/features.h"

namespace helio::gpu {
namespace {

constexpr std::array kDeviceExtensions{
    VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
    VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME,
    VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME,
};
constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr const char* kHowToGetRayTracing =
    "for software rendering install Mesa 24.1 or newer (Debian 12: mesa-vulkan-drivers from bookworm-backports), for "
    "an "
    "NVIDIA GPU driver 525 or newer; deploy/build installs lavapipe";

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

VkPhysicalDeviceProperties properties(VkPhysicalDevice device) {
  VkPhysicalDeviceProperties result;
  vkGetPhysicalDeviceProperties(device, &result);
  return result;
}

bool hasRayTracing(VkPhysicalDevice device) {
  if (properties(device).apiVersion < VK_API_VERSION_1_3) return false;
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, extensions.data());
  return std::all_of(kDeviceExtensions.begin(), kDeviceExtensions.end(), [&](const char* wanted) {
    return std::any_of(extensions.begin(), extensions.end(),
                       [&](const VkExtensionProperties& e) { return std::strcmp(e.extensionName, wanted) == 0; });
  });
}

/// Higher is better: discrete, integrated, virtual, software.
int rank(VkPhysicalDevice device) {
  switch (properties(device).deviceType) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return 1;
    default:
      return 0;
  }
}

bool matches(VkPhysicalDevice device, const std::string& select) {
  const bool cpu = rank(device) == 1;
  if (select == "cpu") return cpu;
  if (select == "gpu") return !cpu;
  return lower(properties(device).deviceName).find(select) != std::string::npos;
}

constexpr std::array kAddressModes{VK_SAMPLER_ADDRESS_MODE_REPEAT, VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT,
                                   VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};

/// In the order in which Bindless::create() makes them.
size_t samplerIndex(const TextureSampling& sampling) {
  const auto mode = [](VkSamplerAddressMode m) {
    return static_cast<size_t>(std::find(kAddressModes.begin(), kAddressModes.end(), m) - kAddressModes.begin());
  };
  return (sampling.nearest ? kAddressModes.size() : 0) * kAddressModes.size() +
         mode(sampling.u) * kAddressModes.size() + mode(sampling.v);
}

}  // namespace

// ---- Bindless
// ----------------------------------------------------------------------------------------------------------

void Bindless::create(VkDevice device, float max_anisotropy) {
  VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  sampler.minFilter = VK_FILTER_LINEAR;
  sampler.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  sampler.maxLod = VK_LOD_CLAMP_NONE;
  sampler.maxAnisotropy = max_anisotropy;
  for (const bool nearest : {false, true}) {
    sampler.magFilter = nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
    sampler.anisotropyEnable = !nearest && max_anisotropy > 1.0f;
    for (const VkSamplerAddressMode u : kAddressModes) {
      for (const VkSamplerAddressMode v : kAddressModes) {
        sampler.addressModeU = u;
        sampler.addressModeV = v;
        check(vkCreateSampler(device, &sampler, nullptr, &samplers_.emplace_back()), "the texture samplers");
      }
    }
  }

  const std::array<VkDescriptorSetLayoutBinding, 2> bindings{{
      {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kTextures, VK_SHADER_STAGE_ALL, nullptr},
      {1, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, kStorageImages, VK_SHADER_STAGE_ALL, nullptr},
  }};
  constexpr VkDescriptorBindingFlags kFlags = VK_DESCRIPTOR_BINDING_UPDATE_AFTER_BIND_BIT |
                                              VK_DESCRIPTOR_BINDING_PARTIALLY_BOUND_BIT |
                                              VK_DESCRIPTOR_BINDING_UPDATE_UNUSED_WHILE_PENDING_BIT;
  const std::array<VkDescriptorBindingFlags, 2> flags{kFlags, kFlags};
  VkDescriptorSetLayoutBindingFlagsCreateInfo binding_flags{
      VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_BINDING_FLAGS_CREATE_INFO};
  binding_flags.bindingCount = static_cast<uint32_t>(flags.size());
  binding_flags.pBindingFlags = flags.data();
  VkDescriptorSetLayoutCreateInfo layout{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  layout.pNext = &binding_flags;
  layout.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_UPDATE_AFTER_BIND_POOL_BIT;
  layout.bindingCount = static_cast<uint32_t>(bindings.size());
  layout.pBindings = bindings.data();
  check(vkCreateDescriptorSetLayout(device, &layout, nullptr, &layout_), "the bindless set's layout");

  const std::array<VkDescriptorPoolSize, 2> sizes{
      {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kTextures}, {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, kStorageImages}}};
  VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  pool.flags = VK_DESCRIPTOR_POOL_CREATE_UPDATE_AFTER_BIND_BIT;
  pool.maxSets = 1;
  pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  check(vkCreateDescriptorPool(device, &pool, nullptr, &pool_), "the bindless set's pool");
  VkDescriptorSetAllocateInfo allocate{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  allocate.descriptorPool = pool_;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &layout_;
  check(vkAllocateDescriptorSets(device, &allocate, &set_), "the bindless set");
}

void Bindless::destroy(VkDevice device) {
  vkDestroyDescriptorPool(device, pool_, nullptr);
  vkDestroyDescriptorSetLayout(device, layout_, nullptr);
  for (const VkSampler sampler : samplers_) vkDestroySampler(device, sampler, nullptr);
}

uint32_t Bindless::add(VkDevice device, VkImageView view, bool storage, const TextureSampling& sampling) {
  const std::lock_guard lock(mutex_);
  Slots& slots = slots_[storage];
  uint32_t slot = slots.next;
  if (!slots.free.empty()) {
    slot = slots.free.back();
    slots.free.pop_back();
  } else if (slots.next == slots.capacity) {
    throw Failure({ErrorKind::limit,
                   std::string("all ") + std::to_string(slots.capacity) + (storage ? " storage images" : " textures") +
                       " of the bindless set are in use: delete a world or a viewer",
                   {},
                   {},
                   std::to_string(slots.capacity)});
  } else {
    ++slots.next;
  }
  VkDescriptorImageInfo image{samplers_[samplerIndex(sampling)], view, VK_IMAGE_LAYOUT_GENERAL};
  VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
  write.dstSet = set_;
  write.dstBinding = storage ? 1 : 0;
  write.dstArrayElement = slot;
  write.descriptorCount = 1;
  write.descriptorType = storage ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  write.pImageInfo = &image;
  vkUpdateDescriptorSets(device, 1, &write, 0, nullptr);
  return slot;
}

void Bindless::remove(uint32_t slot, bool storage) {
  const std::lock_guard lock(mutex_);
  slots_[storage].free.push_back(slot);
}

// ---- Device
// ------------------------------------------------------------------------------------------------------------

Result<std::unique_ptr<Device>> Device::create(const DeviceOptions& options) {
  std::unique_ptr<Device> device(new Device);
  device->options_ = options;
  if (device->options_.select.empty())
    if (const char* variable = std::getenv("HELIOGRAPH_DEVICE")) device->options_.select = variable;
  device->options_.select = lower(device->options_.select);
  try {
    if (auto instance = device->createInstance(); !instance) return instance.error();
    if (auto chosen = device->choosePhysicalDevice(); !chosen) return chosen.error();
    device->createDevice();
  } catch (const Failure& failure) { return failure.error(); }
  spdlog::info("Vulkan device: {} ({}){}", device->name_, device->driver_, device->cpu_ ? ", in software" : "");
  return device;
}

Result<void> Device::createInstance() {
  static const VkResult loader = volkInitialize();
  if (loader != VK_SUCCESS)
    return Error{
        ErrorKind::unsupported, "no Vulkan loader (libvulkan.so.1) on this machine: install libvulkan1", {}, {}, {}};

  std::vector<const char*> layers;
  std::vector<const char*> extensions;
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  const VkValidationFeatureEnableEXT synchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &synchronisation;
  VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT;
  messenger.pfnUserCallback = &Device::onMessage;
  messenger.pUserData = this;

  VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  application.pApplicationName = "heliograph";
  application.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &application;
  if (options_.validation) {
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    info.pNext = &features;
  }
  info.enabledLayerCount = static_cast<uint32_t>(layers.size());
  info.ppEnabledLayerNames = layers.data();
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult created = vkCreateInstance(&info, nullptr, &instance_);
  if (created == VK_ERROR_LAYER_NOT_PRESENT)
    return Error{ErrorKind::unsupported,
                 std::string("validation was asked for, but the layer ") + kValidationLayer +
                     " is not installed: install vulkan-validationlayers",
                 {},
                 {},
                 {}};
  if (created != VK_SUCCESS)
    return Error{ErrorKind::unsupported,
                 std::string("no Vulkan driver could be loaded (") + gpu::name(created) + "): " + kHowToGetRayTracing,
                 {},
                 {},
                 {}};
  volkLoadInstance(instance_);
  if (options_.validation)
    check(vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_), "the validation messenger");
  return {};
}

Result<void> Device::choosePhysicalDevice() {
  uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance_, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  vkEnumeratePhysicalDevices(instance_, &count, devices.data());
  std::string listed;
  for (VkPhysicalDevice d : devices)
    listed += (listed.empty() ? "" : ", ") + std::string("'") + properties(d).deviceName + "'";
  if (devices.empty())
    return Error{
        ErrorKind::unsupported, std::string("no Vulkan device on this machine: ") + kHowToGetRayTracing, {}, {}, {}};

  const std::string& select = options_.select;
  std::vector<VkPhysicalDevice> wanted;
  for (VkPhysicalDevice d : devices)
    if (select.empty() || matches(d, select)) wanted.push_back(d);
  if (wanted.empty())
    return Error{
        ErrorKind::not_found, "no Vulkan device matches '" + select + "'; there are: " + listed, "device", select, {}};

  std::stable_sort(wanted.begin(), wanted.end(), [](auto a, auto b) { return rank(a) > rank(b); });
  const auto able = std::find_if(wanted.begin(), wanted.end(), hasRayTracing);
  if (able == wanted.end())
    return Error{
        ErrorKind::unsupported,
        std::string("'") + properties(wanted.front()).deviceName +
            "' has no Vulkan 1.3 with ray tracing pipelines (VK_KHR_ray_tracing_pipeline): " + kHowToGetRayTracing,
        "device",
        select,
        {}};
  if (const std::string missing = Features::missing(*able); !missing.empty())
    return Error{ErrorKind::unsupported,
                 std::string("'") + properties(*able).deviceName + "' lacks what the renderer needs of Vulkan: " +
                     missing + "; choose another device, or install a newer driver: " + kHowToGetRayTracing,
                 "device",
                 select,
                 {}};
  if (able != wanted.begin())
    spdlog::warn("'{}' has no ray tracing pipelines, using '{}'", properties(wanted.front()).deviceName,
                 properties(*able).deviceName);
  physical_ = *able;
  return {};
}

void Device::createDevice() {
  VkPhysicalDeviceAccelerationStructurePropertiesKHR acceleration{
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_PROPERTIES_KHR};
  ray_tracing_ = {VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_TRACING_PIPELINE_PROPERTIES_KHR};
  ray_tracing_.pNext = &acceleration;
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  driver.pNext = &ray_tracing_;
  VkPhysicalDeviceMaintenance4Properties sizes{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_PROPERTIES};
  sizes.pNext = &driver;
  VkPhysicalDeviceProperties2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  all.pNext = &sizes;
  vkGetPhysicalDeviceProperties2(physical_, &all);
  name_ = all.properties.deviceName;
  driver_ = std::string(driver.driverName) + " " + driver.driverInfo;
  cpu_ = all.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
  timestamp_period_ = all.properties.limits.timestampPeriod;
  scratch_alignment_ = acceleration.minAccelerationStructureScratchOffsetAlignment;
  max_buffer_size_ = sizes.maxBufferSize;
  ray_tracing_.pNext = nullptr;

  chooseQueues();

  Features features;
  features.requireAll();

  const float priority = 1.0f;
  std::vector<VkDeviceQueueCreateInfo> queues;
  for (const Lane& lane : lanes_) {
    if (!queues.empty() && queues.front().queueFamilyIndex == lane.family) continue;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = lane.family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    queues.push_back(queue);
  }
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.pNext = &features.chain();
  info.queueCreateInfoCount = static_cast<uint32_t>(queues.size());
  info.pQueueCreateInfos = queues.data();
  info.enabledExtensionCount = static_cast<uint32_t>(kDeviceExtensions.size());
  info.ppEnabledExtensionNames = kDeviceExtensions.data();
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "the device '" + name_ + "' (" + driver_ + ")");
  for (Lane& lane : lanes_) vkGetDeviceQueue(device_, lane.family, 0, &lane.handle);

  VmaVulkanFunctions functions{};
  functions.vkGetInstanceProcAddr = vkGetInstanceProcAddr;
  functions.vkGetDeviceProcAddr = vkGetDeviceProcAddr;
  VmaAllocatorCreateInfo allocator{};
  allocator.flags = VMA_ALLOCATOR_CREATE_BUFFER_DEVICE_ADDRESS_BIT;
  allocator.instance = instance_;
  allocator.physicalDevice = physical_;
  allocator.device = device_;
  allocator.pVulkanFunctions = &functions;
  allocator.vulkanApiVersion = VK_API_VERSION_1_3;
  check(vmaCreateAllocator(&allocator, &allocator_), "the memory allocator");

  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  semaphore.pNext = &type;
  for (Lane& lane : lanes_)
    check(vkCreateSemaphore(device_, &semaphore, nullptr, &lane.timeline), "a queue's timeline");

  // Software texture filtering pays for every tap of an anisotropic read.
  bindless_.create(device_, cpu_ ? 1.0f : std::min(8.0f, all.properties.limits.maxSamplerAnisotropy));
  const VkDescriptorSetLayout set_layout = bindless_.layout();
  const VkPushConstantRange range{VK_SHADER_STAGE_ALL, 0, kPushConstantBytes};
  VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  check(vkCreatePipelineLayout(device_, &layout, nullptr, &pipeline_layout_), "the pipeline layout");
}

Device::~Device() {
  if (device_) {
    vkDeviceWaitIdle(device_);
    if (pipeline_layout_) vkDestroyPipelineLayout(device_, pipeline_layout_, nullptr);
    bindless_.destroy(device_);
    for (const Lane& lane : lanes_) vkDestroySemaphore(device_, lane.timeline, nullptr);
    if (allocator_) vmaDestroyAllocator(allocator_);
    vkDestroyDevice(device_, nullptr);
  }
  if (messenger_) vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

void Device::chooseQueues() {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical_, &count, families.data());
  const auto find = [&](VkQueueFlags wanted, VkQueueFlags unwanted) {
    return static_cast<uint32_t>(std::find_if(families.begin(), families.end(),
                                              [&](const VkQueueFamilyProperties& family) {
                                                return (family.queueFlags & wanted) == wanted &&
                                                       (family.queueFlags & unwanted) == 0 &&
                                                       family.timestampValidBits > 0;
                                              }) -
                                 families.begin());
  };
  const uint32_t main = find(VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT, 0);
  if (main == count)
    throw Failure({ErrorKind::unsupported,
                   "'" + name_ + "' has no queue for graphics and compute with timestamps",
                   "device",
                   name_,
                   {}});
  const uint32_t async = find(VK_QUEUE_COMPUTE_BIT, VK_QUEUE_GRAPHICS_BIT);
  lane(Queue::main).family = main;
  lane(Queue::async).family = async == count ? main : async;
}

Point Device::submit(Queue queue, VkCommandBuffer commands, const Point& after) {
  const std::lock_guard lock(queue_mutex_);
  Lane& to = lane(queue);
  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands;
  VkSemaphoreSubmitInfo signal{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  signal.semaphore = to.timeline;
  signal.value = to.value + 1;
  signal.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkSemaphoreSubmitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO};
  wait.semaphore = lane(after.queue).timeline;
  wait.value = after.value;
  wait.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  submit.waitSemaphoreInfoCount = after.value > 0 ? 1 : 0;
  submit.pWaitSemaphoreInfos = &wait;
  submit.commandBufferInfoCount = 1;
  submit.pCommandBufferInfos = &buffer;
  submit.signalSemaphoreInfoCount = 1;
  submit.pSignalSemaphoreInfos = &signal;
  check(vkQueueSubmit2(to.handle, 1, &submit, VK_NULL_HANDLE), "submitting a frame");
  return {queue, ++to.value};
}

void Device::wait(const Point& point) {
  VkSemaphoreWaitInfo wait{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
  wait.semaphoreCount = 1;
  wait.pSemaphores = &lane(point.queue).timeline;
  wait.pValues = &point.value;
  check(vkWaitSemaphores(device_, &wait, UINT64_MAX), "waiting for a frame");
}

VkBool32 Device::onMessage(VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                           const VkDebugUtilsMessengerCallbackDataEXT* data, void* self) {
  auto* device = static_cast<Device*>(self);
  if (severity < VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) {
    spdlog::debug("validation: {}", data->pMessage);
    return VK_FALSE;
  }
  ++device->validation_errors_;
  spdlog::error("validation: {}", data->pMessage);
  return VK_FALSE;
}

}  // namespace helio::gpu
