#include "swapchain.h"

#include <algorithm>

#include "sightcell/base/error.h"

namespace vulkan_host {
namespace {

VkSurfaceFormatKHR choose_format(const device& on, VkSurfaceKHR surface) {
  std::uint32_t count = 0;
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(on.physical(), surface, &count, nullptr),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  std::vector<VkSurfaceFormatKHR> formats(count);
  check(vkGetPhysicalDeviceSurfaceFormatsKHR(on.physical(), surface, &count, formats.data()),
        "vkGetPhysicalDeviceSurfaceFormatsKHR");
  const auto srgb = std::find_if(formats.begin(), formats.end(), [](const VkSurfaceFormatKHR& f) {
    return f.format == VK_FORMAT_B8G8R8A8_SRGB || f.format == VK_FORMAT_R8G8B8A8_SRGB;
  });
  return srgb != formats.end() ? *srgb : formats.front();
}

VkExtent2D size_of(const VkSurfaceCapabilitiesKHR& can, VkExtent2D window) {
  if (can.currentExtent.width != UINT32_MAX) return can.currentExtent;
  return {std::clamp(window.width, can.minImageExtent.width, can.maxImageExtent.width),
          std::clamp(window.height, can.minImageExtent.height, can.maxImageExtent.height)};
}

}  // namespace

swapchain::swapchain(const device& on, VkSurfaceKHR surface, VkExtent2D size) : device_(on), surface_(surface) {
  recreate(size);
}

void swapchain::recreate(VkExtent2D size) {
  check(vkDeviceWaitIdle(device_.get()), "vkDeviceWaitIdle");  // also for what is being shown
  VkSurfaceCapabilitiesKHR can{};
  check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &can),
        "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
  if ((can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0) {
    throw sightcell::error(sightcell::error_kind::failed, "vulkan.window", device_.name(),
                           "cannot copy pictures into this window", "run without --window");
  }
  const VkSurfaceFormatKHR format = choose_format(device_, surface_);
  size_ = size_of(can, size);
  const std::uint32_t most = can.maxImageCount == 0 ? UINT32_MAX : can.maxImageCount;
  const VkSwapchainCreateInfoKHR info{.sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
                                      .surface = surface_,
                                      .minImageCount = std::min(can.minImageCount + 1, most),
                                      .imageFormat = format.format,
                                      .imageColorSpace = format.colorSpace,
                                      .imageExtent = size_,
                                      .imageArrayLayers = 1,
                                      .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                      .preTransform = can.currentTransform,
                                      .compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR,
                                      .presentMode = VK_PRESENT_MODE_FIFO_KHR,
                                      .clipped = VK_TRUE,
                                      .oldSwapchain = swapchain_.get()};
  swapchain_ = make<owned_swapchain>(device_.get(), vkCreateSwapchainKHR, info, "vkCreateSwapchainKHR");
  std::uint32_t count = 0;
  check(vkGetSwapchainImagesKHR(device_.get(), swapchain_.get(), &count, nullptr), "vkGetSwapchainImagesKHR");
  images_.resize(count);
  check(vkGetSwapchainImagesKHR(device_.get(), swapchain_.get(), &count, images_.data()), "vkGetSwapchainImagesKHR");
  drawn_.clear();
  const VkSemaphoreCreateInfo semaphore{.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  for (std::uint32_t i = 0; i < count; ++i)
    drawn_.push_back(make<owned_semaphore>(device_.get(), vkCreateSemaphore, semaphore, "vkCreateSemaphore"));
}

std::optional<std::uint32_t> swapchain::acquire(VkSemaphore acquired) {
  std::uint32_t image = 0;
  const VkResult got =
      vkAcquireNextImageKHR(device_.get(), swapchain_.get(), UINT64_MAX, acquired, VK_NULL_HANDLE, &image);
  if (got == VK_ERROR_OUT_OF_DATE_KHR) return std::nullopt;
  check(got, "vkAcquireNextImageKHR");
  return image;
}

void swapchain::record_copy(VkCommandBuffer commands, const target& from, std::uint32_t image) const {
  constexpr VkImageAspectFlags color = VK_IMAGE_ASPECT_COLOR_BIT;
  // The wait for `acquired` is in the transfer stage, so this change waits for it there.
  change_layout(commands, images_[image], color,
                {VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
                 VK_PIPELINE_STAGE_TRANSFER_BIT, 0, VK_ACCESS_TRANSFER_WRITE_BIT});
  const auto corner = [](VkExtent2D size) {
    return VkOffset3D{static_cast<std::int32_t>(size.width), static_cast<std::int32_t>(size.height), 1};
  };
  const VkImageBlit whole{.srcSubresource = {color, 0, 0, 1},
                          .srcOffsets = {{}, corner(from.size())},
                          .dstSubresource = {color, 0, 0, 1},
                          .dstOffsets = {{}, corner(size_)}};
  vkCmdBlitImage(commands, from.color(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, images_[image],
                 VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole, VK_FILTER_NEAREST);
  change_layout(commands, images_[image], color,
                {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_TRANSFER_BIT,
                 VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, 0});
}

bool swapchain::present(std::uint32_t image) {
  const VkPresentInfoKHR info{.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                              .waitSemaphoreCount = 1,
                              .pWaitSemaphores = drawn_[image].address(),
                              .swapchainCount = 1,
                              .pSwapchains = swapchain_.address(),
                              .pImageIndices = &image};
  const VkResult got = vkQueuePresentKHR(device_.queue(), &info);
  if (got == VK_ERROR_OUT_OF_DATE_KHR || got == VK_SUBOPTIMAL_KHR) return false;
  check(got, "vkQueuePresentKHR");
  return true;
}

}  // namespace vulkan_host
