#pragma once
// The Vulkan instance, and a device with one queue that draws, computes and presents.
#include <vulkan/vulkan.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "owned.h"

namespace vulkan_host {

class instance {
 public:
  // extensions: those of a window, or none.
  // validate: with the validation layer, whose messages go to standard error.
  // Throws vulkan.no-driver, vulkan.no-validation.
  instance(std::span<const char* const> extensions, bool validate);
  ~instance();
  instance(const instance&) = delete;
  instance& operator=(const instance&) = delete;

  VkInstance get() const { return instance_; }

  // Warnings and errors of the validation layer so far.
  std::uint32_t validation_messages() const { return messages_; }

 private:
  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  std::atomic<std::uint32_t> messages_ = 0;
};

class device {
 public:
  // The best device that has what the sample needs: a graphics card before a driver for the CPU.
  // surface: of a window, or VK_NULL_HANDLE.
  // may_count: false makes it work as a device without drawIndirectCount.
  // Throws vulkan.no-device.
  device(const instance& of, VkSurfaceKHR surface, bool may_count);
  ~device();
  device(const device&) = delete;
  device& operator=(const device&) = delete;

  VkPhysicalDevice physical() const { return physical_; }
  VkDevice get() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  const VkPhysicalDeviceLimits& limits() const { return limits_; }
  const std::string& name() const { return name_; }

  // vkCmdDrawIndexedIndirectCount may be used.
  bool counts() const { return counts_; }

  // The memory type among `allowed` bits with all `wanted` properties, and if there is one with the `preferred` ones.
  // Throws vulkan.memory if there is none.
  std::uint32_t memory_type(std::uint32_t allowed, VkMemoryPropertyFlags wanted, VkMemoryPropertyFlags preferred) const;

  // Records commands, runs them, and waits until they have ended: for loading and for reading back.
  void run(const std::function<void(VkCommandBuffer)>& record) const;

 private:
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  VkPhysicalDeviceLimits limits_{};
  VkPhysicalDeviceMemoryProperties memory_{};
  std::string name_;
  bool counts_ = false;
  owned_command_pool pool_;
};

}  // namespace vulkan_host
