#pragma once
// Buffers and images with memory of their own. An engine places many in one allocation; this sample has few of them.
#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <span>

#include "device.h"
#include "owned.h"

namespace vulkan_host {

enum class memory_use {
  device,    // written by copies and shaders
  upload,    // mapped; the host writes it each frame. In device memory where the host can map that
  read_back  // mapped; the host reads it
};

class buffer {
 public:
  buffer() = default;
  buffer(const device& on, VkDeviceSize bytes, VkBufferUsageFlags usage, memory_use use);

  VkBuffer get() const { return buffer_.get(); }
  VkDeviceSize bytes() const { return bytes_; }

  // The mapped memory. T: what is in it.
  template <class T>
  std::span<T> mapped() const {
    return {static_cast<T*>(mapped_), static_cast<std::size_t>(bytes_) / sizeof(T)};
  }

 private:
  owned_memory memory_;
  owned_buffer buffer_;
  VkDeviceSize bytes_ = 0;
  void* mapped_ = nullptr;
};

// A buffer of the device with these bytes. At least one element is allocated, so that it can be bound.
buffer upload_buffer(const device& on, std::span<const std::byte> bytes, VkBufferUsageFlags usage);

template <class T>
buffer upload_buffer(const device& on, std::span<const T> elements, VkBufferUsageFlags usage) {
  return upload_buffer(on, std::as_bytes(elements), usage);
}

class image {
 public:
  image() = default;
  // layers: 0 for an image without layers, which shaders do not see as an array.
  image(const device& on, VkExtent2D size, VkFormat format, VkImageUsageFlags usage, VkImageAspectFlags aspect,
        std::uint32_t levels = 1, std::uint32_t layers = 0);

  VkImage get() const { return image_.get(); }
  VkImageView view() const { return view_.get(); }

 private:
  owned_memory memory_;
  owned_image image_;
  owned_image_view view_;
};

// Records a change of the layout of mip levels (of all layers), and what waits for what.
struct image_change {
  VkImageLayout from, to;
  VkPipelineStageFlags after, before;
  VkAccessFlags written, read;
};
void change_layout(VkCommandBuffer commands, VkImage of, VkImageAspectFlags aspect, const image_change& change,
                   std::uint32_t first_level = 0, std::uint32_t levels = 1);

}  // namespace vulkan_host
