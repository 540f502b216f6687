#pragma once
// What is drawn into: a color and a depth image of the sample's own, without a window too.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

#include "device.h"
#include "memory.h"
#include "owned.h"

namespace vulkan_host {

struct picture {
  VkExtent2D size{};
  std::vector<std::uint8_t> rgba;  // sRGB, rows from the top; alpha is the sum of that of blended polygons
  std::vector<float> depths;       // near_plane / meters along the view's axis; 0: nothing opaque
};

// Clears, draws, and leaves the color image ready to be copied from.
owned_render_pass make_render_pass(const device& on);

class target {
 public:
  // pass: must outlive the object.
  target(const device& on, VkRenderPass pass, VkExtent2D size);

  VkExtent2D size() const { return size_; }
  VkImage color() const { return color_.get(); }

  void begin_pass(VkCommandBuffer commands) const;

  // Reads the last picture back. All frames must have ended.
  picture read_back(const device& on) const;

 private:
  VkExtent2D size_;
  VkRenderPass pass_;
  image color_, depth_;
  owned_framebuffer framebuffer_;
};

}  // namespace vulkan_host
