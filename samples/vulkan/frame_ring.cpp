#include "frame_ring.h"

namespace vulkan_host {

frame_ring::frame_ring(const device& on) : device_(on) {
  for (frame& f : frames_) {
    const VkCommandPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                       .flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT,
                                       .queueFamilyIndex = on.queue_family()};
    f.pool = make<owned_command_pool>(on.get(), vkCreateCommandPool, pool, "vkCreateCommandPool");
    const VkCommandBufferAllocateInfo commands{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                               .commandPool = f.pool.get(),
                                               .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                               .commandBufferCount = 1};
    check(vkAllocateCommandBuffers(on.get(), &commands, &f.commands), "vkAllocateCommandBuffers");
    const VkFenceCreateInfo fence{.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    f.done = make<owned_fence>(on.get(), vkCreateFence, fence, "vkCreateFence");
    const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    f.acquired = make<owned_semaphore>(on.get(), vkCreateSemaphore, semaphore, "vkCreateSemaphore");
  }
}

frame_ring::~frame_ring() {
  vkDeviceWaitIdle(device_.get());
}

frame& frame_ring::next() {
  frame& f = frames_[next_];
  next_ = (next_ + 1) % frames_in_flight;
  check(vkWaitForFences(device_.get(), 1, f.done.address(), VK_TRUE, UINT64_MAX), "vkWaitForFences");
  return f;
}

void frame_ring::begin(const frame& f) {
  const VkCommandBufferBeginInfo info{.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
  check(vkBeginCommandBuffer(f.commands, &info), "vkBeginCommandBuffer");
}

void frame_ring::submit(const frame& f, VkSemaphore wait, VkSemaphore signal) const {
  check(vkEndCommandBuffer(f.commands), "vkEndCommandBuffer");
  const VkPipelineStageFlags wait_stage = VK_PIPELINE_STAGE_TRANSFER_BIT;  // where the swapchain's image is written
  const VkSubmitInfo info{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                          .waitSemaphoreCount = wait != VK_NULL_HANDLE ? 1u : 0u,
                          .pWaitSemaphores = &wait,
                          .pWaitDstStageMask = &wait_stage,
                          .commandBufferCount = 1,
                          .pCommandBuffers = &f.commands,
                          .signalSemaphoreCount = signal != VK_NULL_HANDLE ? 1u : 0u,
                          .pSignalSemaphores = &signal};
  check(vkResetFences(device_.get(), 1, f.done.address()), "vkResetFences");
  check(vkQueueSubmit(device_.queue(), 1, &info, f.done.get()), "vkQueueSubmit");
}

}  // namespace vulkan_host
