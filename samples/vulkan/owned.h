#pragma once
// Owners of Vulkan handles: a handle is destroyed with its owner. An engine has something like this already.
#include <vulkan/vulkan.h>

#include <string>
#include <utility>

#include "sightcell/base/error.h"

namespace vulkan_host {

// Throws if a call of Vulkan has failed. call: its name.
inline void check(VkResult result, const char* call) {
  if (result >= 0) return;
  throw sightcell::error(sightcell::error_kind::failed, "vulkan.call", call,
                         "failed with VkResult " + std::to_string(result),
                         "try another driver (VK_DRIVER_FILES) or --validate");
}

// destroy: vkDestroy... or vkFree... of the handle.
template <class Handle, auto destroy>
class owned {
 public:
  owned() = default;
  owned(VkDevice device, Handle handle) : device_(device), handle_(handle) {}
  ~owned() {
    if (handle_ != VK_NULL_HANDLE) destroy(device_, handle_, nullptr);
  }
  owned(owned&& other) noexcept
      : device_(other.device_), handle_(std::exchange(other.handle_, Handle{VK_NULL_HANDLE})) {}
  owned& operator=(owned&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    return *this;
  }
  owned(const owned&) = delete;
  owned& operator=(const owned&) = delete;

  Handle get() const { return handle_; }
  const Handle* address() const { return &handle_; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_ = VK_NULL_HANDLE;
};

using owned_buffer = owned<VkBuffer, vkDestroyBuffer>;
using owned_memory = owned<VkDeviceMemory, vkFreeMemory>;
using owned_image = owned<VkImage, vkDestroyImage>;
using owned_image_view = owned<VkImageView, vkDestroyImageView>;
using owned_sampler = owned<VkSampler, vkDestroySampler>;
using owned_render_pass = owned<VkRenderPass, vkDestroyRenderPass>;
using owned_framebuffer = owned<VkFramebuffer, vkDestroyFramebuffer>;
using owned_shader = owned<VkShaderModule, vkDestroyShaderModule>;
using owned_set_layout = owned<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using owned_descriptor_pool = owned<VkDescriptorPool, vkDestroyDescriptorPool>;
using owned_pipeline_layout = owned<VkPipelineLayout, vkDestroyPipelineLayout>;
using owned_pipeline = owned<VkPipeline, vkDestroyPipeline>;
using owned_command_pool = owned<VkCommandPool, vkDestroyCommandPool>;
using owned_fence = owned<VkFence, vkDestroyFence>;
using owned_semaphore = owned<VkSemaphore, vkDestroySemaphore>;
using owned_swapchain = owned<VkSwapchainKHR, vkDestroySwapchainKHR>;

// make<owned_fence>(device, vkCreateFence, info): what vkCreate... makes, with its owner.
template <class Owner, class Info, class Handle>
Owner make(VkDevice device, VkResult (*create)(VkDevice, const Info*, const VkAllocationCallbacks*, Handle*),
           const Info& info, const char* call) {
  Handle handle = VK_NULL_HANDLE;
  check(create(device, &info, nullptr, &handle), call);
  return Owner(device, handle);
}

}  // namespace vulkan_host
