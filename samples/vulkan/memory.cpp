#include "memory.h"

#include <algorithm>
#include <cstring>

namespace vulkan_host {
namespace {

struct memory_kind {
  VkMemoryPropertyFlags wanted, preferred;
};

memory_kind kind_of(memory_use use) {
  constexpr VkMemoryPropertyFlags mapped = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  switch (use) {
    case memory_use::upload:
      return {mapped, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
    case memory_use::read_back:
      return {mapped, VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
    default:
      return {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
  }
}

owned_memory allocate(const device& on, const VkMemoryRequirements& needs, const memory_kind& kind) {
  const VkMemoryAllocateInfo info{.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                  .allocationSize = needs.size,
                                  .memoryTypeIndex = on.memory_type(needs.memoryTypeBits, kind.wanted, kind.preferred)};
  return make<owned_memory>(on.get(), vkAllocateMemory, info, "vkAllocateMemory");
}

}  // namespace

buffer::buffer(const device& on, VkDeviceSize bytes, VkBufferUsageFlags usage, memory_use use)
    : bytes_(std::max<VkDeviceSize>(bytes, 16)) {
  const VkBufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes_, .usage = usage};
  buffer_ = make<owned_buffer>(on.get(), vkCreateBuffer, info, "vkCreateBuffer");
  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(on.get(), buffer_.get(), &needs);
  memory_ = allocate(on, needs, kind_of(use));
  check(vkBindBufferMemory(on.get(), buffer_.get(), memory_.get(), 0), "vkBindBufferMemory");
  if (use != memory_use::device)
    check(vkMapMemory(on.get(), memory_.get(), 0, VK_WHOLE_SIZE, 0, &mapped_), "vkMapMemory");
}

buffer upload_buffer(const device& on, std::span<const std::byte> bytes, VkBufferUsageFlags usage) {
  buffer out(on, bytes.size(), usage | VK_BUFFER_USAGE_TRANSFER_DST_BIT, memory_use::device);
  if (bytes.empty()) return out;
  const buffer staging(on, bytes.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, memory_use::upload);
  std::memcpy(staging.mapped<std::byte>().data(), bytes.data(), bytes.size());
  on.run([&](VkCommandBuffer commands) {
    const VkBufferCopy whole{.size = bytes.size()};
    vkCmdCopyBuffer(commands, staging.get(), out.get(), 1, &whole);
  });
  return out;
}

image::image(const device& on, VkExtent2D size, VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect,
             std::uint32_t levels, std::uint32_t layers) {
  const VkImageCreateInfo info{.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                               .imageType = VK_IMAGE_TYPE_2D,
                               .format = format,
                               .extent = {size.width, size.height, 1},
                               .mipLevels = levels,
                               .arrayLayers = std::max(layers, 1u),
                               .samples = VK_SAMPLE_COUNT_1_BIT,
                               .usage = usage};
  image_ = make<owned_image>(on.get(), vkCreateImage, info, "vkCreateImage");
  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(on.get(), image_.get(), &needs);
  memory_ = allocate(on, needs, kind_of(memory_use::device));
  check(vkBindImageMemory(on.get(), image_.get(), memory_.get(), 0), "vkBindImageMemory");
  const VkImageViewCreateInfo view{.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                   .image = image_.get(),
                                   .viewType = layers == 0 ? VK_IMAGE_VIEW_TYPE_2D : VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                   .format = format,
                                   .subresourceRange = {aspect, 0, levels, 0, std::max(layers, 1u)}};
  view_ = make<owned_image_view>(on.get(), vkCreateImageView, view, "vkCreateImageView");
}

void change_layout(VkCommandBuffer commands, VkImage of, VkImageAspectFlags aspect, const image_change& change,
                   std::uint32_t first_level, std::uint32_t levels) {
  const VkImageMemoryBarrier barrier{.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                     .srcAccessMask = change.written,
                                     .dstAccessMask = change.read,
                                     .oldLayout = change.from,
                                     .newLayout = change.to,
                                     .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                     .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                     .image = of,
                                     .subresourceRange = {aspect, first_level, levels, 0, VK_REMAINING_ARRAY_LAYERS}};
  vkCmdPipelineBarrier(commands, change.after, change.before, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

}  // namespace vulkan_host
