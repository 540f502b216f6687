#include "device.h"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <optional>
#include <vector>

namespace vulkan_host {
namespace {

using sightcell::error;
using sightcell::error_kind;

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL report_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                              const VkDebugUtilsMessengerCallbackDataEXT* data, void* count) {
  fmt::print(stderr, "{}\n", data->pMessage);
  ++*static_cast<std::atomic<std::uint32_t>*>(count);
  return VK_FALSE;
}

bool has_validation_layer() {
  std::uint32_t count = 0;
  check(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
  std::vector<VkLayerProperties> layers(count);
  check(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
  for (const VkLayerProperties& l : layers) {
    if (std::strcmp(l.layerName, validation_layer) == 0) return true;
  }
  return false;
}

// ---- which device ----

struct candidate {
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  std::uint32_t queue_family = 0;
  VkPhysicalDeviceProperties properties{};
  bool counts = false;
};

int preference(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return 2;
    default:
      return 1;
  }
}

// A queue for everything keeps the sample small. Each device that can draw has one that also computes.
std::optional<std::uint32_t> find_queue_family(VkPhysicalDevice physical, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  for (std::uint32_t f = 0; f < count; ++f) {
    constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    if ((families[f].queueFlags & needed) != needed) continue;
    VkBool32 presents = VK_TRUE;
    if (surface != VK_NULL_HANDLE) {
      check(vkGetPhysicalDeviceSurfaceSupportKHR(physical, f, surface, &presents),
            "vkGetPhysicalDeviceSurfaceSupportKHR");
    }
    if (presents == VK_TRUE) return f;
  }
  return std::nullopt;
}

std::optional<candidate> examine(VkPhysicalDevice physical, VkSurfaceKHR surface) {
  candidate out{.physical = physical};
  vkGetPhysicalDeviceProperties(physical, &out.properties);
  if (out.properties.apiVersion < VK_API_VERSION_1_2) return std::nullopt;
  VkPhysicalDeviceVulkan12Features of_1_2{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 features{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &of_1_2};
  vkGetPhysicalDeviceFeatures2(physical, &features);
  if (features.features.multiDrawIndirect == VK_FALSE || features.features.drawIndirectFirstInstance == VK_FALSE)
    return std::nullopt;
  out.counts = of_1_2.drawIndirectCount == VK_TRUE;
  const std::optional<std::uint32_t> family = find_queue_family(physical, surface);
  if (!family) return std::nullopt;
  out.queue_family = *family;
  return out;
}

candidate choose(VkInstance instance, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  check(vkEnumeratePhysicalDevices(instance, &count, nullptr), "vkEnumeratePhysicalDevices");
  std::vector<VkPhysicalDevice> all(count);
  check(vkEnumeratePhysicalDevices(instance, &count, all.data()), "vkEnumeratePhysicalDevices");
  std::optional<candidate> best;
  for (VkPhysicalDevice physical : all) {
    const std::optional<candidate> found = examine(physical, surface);
    if (!found) continue;
    if (!best || preference(found->properties.deviceType) > preference(best->properties.deviceType)) best = found;
  }
  if (best) return *best;
  throw error(error_kind::failed, "vulkan.no-device", "Vulkan",
              fmt::format("none of {} devices has version 1.2, multiDrawIndirect, drawIndirectFirstInstance and a "
                          "queue for everything",
                          count),
              "update the driver, or install one for the CPU (Debian: mesa-vulkan-drivers)");
}

}  // namespace

// ---- instance ----

instance::instance(std::span<const char* const> extensions, bool validate) {
  std::vector<const char*> wanted(extensions.begin(), extensions.end());
  if (validate) {
    if (!has_validation_layer()) {
      throw error(error_kind::failed, "vulkan.no-validation", validation_layer, "is not installed",
                  "install it (Debian: vulkan-validationlayers), or leave --validate out");
    }
    wanted.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  const VkDebugUtilsMessengerCreateInfoEXT messages{.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
                                                    .messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                                                                       VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
                                                    .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
                                                    .pfnUserCallback = report_message,
                                                    .pUserData = &messages_};
  const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  const VkValidationFeaturesEXT checks{.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                       .pNext = &messages,
                                       .enabledValidationFeatureCount = 1,
                                       .pEnabledValidationFeatures = &synchronization};
  const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                      .pApplicationName = "sightcell-vulkan",
                                      .apiVersion = VK_API_VERSION_1_2};
  const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                  .pNext = validate ? &checks : nullptr,
                                  .pApplicationInfo = &application,
                                  .enabledLayerCount = validate ? 1u : 0u,
                                  .ppEnabledLayerNames = &validation_layer,
                                  .enabledExtensionCount = static_cast<std::uint32_t>(wanted.size()),
                                  .ppEnabledExtensionNames = wanted.data()};
  if (const VkResult result = vkCreateInstance(&info, nullptr, &instance_); result != VK_SUCCESS) {
    throw error(error_kind::failed, "vulkan.no-driver", "Vulkan", fmt::format("no instance, VkResult {}", int{result}),
                "install a driver (Debian: mesa-vulkan-drivers, or that of the graphics card)");
  }
  if (!validate) return;
  const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(
      vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
  check(create(instance_, &messages, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
}

instance::~instance() {
  if (messenger_ != VK_NULL_HANDLE) {
    const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(
        vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
    destroy(instance_, messenger_, nullptr);
  }
  vkDestroyInstance(instance_, nullptr);
}

// ---- device ----

device::device(const instance& of, VkSurfaceKHR surface, bool may_count) {
  const candidate chosen = choose(of.get(), surface);
  physical_ = chosen.physical;
  queue_family_ = chosen.queue_family;
  limits_ = chosen.properties.limits;
  name_ = chosen.properties.deviceName;
  counts_ = chosen.counts && may_count;
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);

  const float priority = 1.0f;
  const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                      .queueFamilyIndex = queue_family_,
                                      .queueCount = 1,
                                      .pQueuePriorities = &priority};
  VkPhysicalDeviceVulkan12Features of_1_2{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES,
                                          .drawIndirectCount = counts_ ? VK_TRUE : VK_FALSE};
  const VkPhysicalDeviceFeatures features{.multiDrawIndirect = VK_TRUE, .drawIndirectFirstInstance = VK_TRUE};
  const char* const presents = VK_KHR_SWAPCHAIN_EXTENSION_NAME;
  const VkDeviceCreateInfo info{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                .pNext = &of_1_2,
                                .queueCreateInfoCount = 1,
                                .pQueueCreateInfos = &queue,
                                .enabledExtensionCount = surface != VK_NULL_HANDLE ? 1u : 0u,
                                .ppEnabledExtensionNames = &presents,
                                .pEnabledFeatures = &features};
  check(vkCreateDevice(physical_, &info, nullptr, &device_), "vkCreateDevice");
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
  const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                     .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                     .queueFamilyIndex = queue_family_};
  pool_ = make<owned_command_pool>(device_, vkCreateCommandPool, pool, "vkCreateCommandPool");
}

device::~device() {
  pool_ = {};
  vkDestroyDevice(device_, nullptr);
}

std::uint32_t device::memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted,
                                  VkMemoryPropertyFlags preferred) const {
  for (const VkMemoryPropertyFlags needed : {wanted | preferred, wanted}) {
    for (std::uint32_t t = 0; t < memory_.memoryTypeCount; ++t) {
      if ((allowed >> t & 1u) != 0 && (memory_.memoryTypes[t].propertyFlags & needed) == needed) return t;
    }
  }
  throw error(error_kind::failed, "vulkan.memory", name_, "has no memory of the kind that a buffer needs",
              "try another driver (VK_DRIVER_FILES)");
}

void device::run(const std::function<void(VkCommandBuffer)>& record) const {
  const VkCommandBufferAllocateInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                         .commandPool = pool_.get(),
                                         .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                         .commandBufferCount = 1};
  VkCommandBuffer commands = VK_NULL_HANDLE;
  check(vkAllocateCommandBuffers(device_, &info, &commands), "vkAllocateCommandBuffers");
  const VkCommandBufferBeginInfo begin{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                       .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
  record(commands);
  check(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  const VkSubmitInfo submit{
      .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
  check(vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
  check(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
  vkFreeCommandBuffers(device_, pool_.get(), 1, &commands);
}

}  // namespace vulkan_host
