#pragma once
// The images of a window, which the picture is copied into.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "device.h"
#include "owned.h"
#include "target.h"

namespace vulkan_host {

class swapchain {
 public:
  // on, surface: must outlive the object. size: of the window in pixels, where the surface does not tell.
  swapchain(const device& on, VkSurfaceKHR surface, VkExtent2D size);

  VkExtent2D size() const { return size_; }

  // The image for the next frame; nothing if the window has changed, after which recreate has to be called.
  // acquired: signaled when the image may be written.
  std::optional<std::uint32_t> acquire(VkSemaphore acquired);

  // Records the copy of the picture into an image.
  void record_copy(VkCommandBuffer commands, const target& from, std::uint32_t image) const;

  // Signaled by the frame that writes the image. One for each image: an image that is acquired again has been shown,
  // and its semaphore is free then. The end of a frame does not tell that.
  VkSemaphore drawn(std::uint32_t image) const { return drawn_[image].get(); }

  // False if the window has changed.
  bool present(std::uint32_t image);

  // After a change of the window. Waits for the device.
  void recreate(VkExtent2D size);

 private:
  const device& device_;
  VkSurfaceKHR surface_;
  owned_swapchain swapchain_;
  std::vector<VkImage> images_;
  std::vector<owned_semaphore> drawn_;
  VkExtent2D size_{};
};

}  // namespace vulkan_host
