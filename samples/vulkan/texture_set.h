#pragma once
// The base color textures of the scene, with mip levels, as the layers of one array: all draws of a pipeline share it.
// Images are resized to one size for that. An engine that requires descriptor indexing keeps their sizes.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

#include "device.h"
#include "memory.h"
#include "sightcell/scene/scene.h"

namespace vulkan_host {

class texture_set {
 public:
  // images: host_scene::textures of s. One that cannot be decoded is white.
  // Throws vulkan.limit if there are more than the device has layers.
  texture_set(const device& on, const sightcell::scene::scene& s, const std::vector<std::uint32_t>& images);

  VkDescriptorImageInfo descriptor() const {
    return {sampler_.get(), array_.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  }

 private:
  image array_;
  owned_sampler sampler_;
};

}  // namespace vulkan_host
