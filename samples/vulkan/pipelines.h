#pragma once
// Descriptor layouts and pipelines: one graphics pipeline for each bin of the scene, two compute pipelines that cull.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <vector>

#include "device.h"
#include "host_scene.h"
#include "owned.h"

namespace vulkan_host {

class pipelines {
 public:
  pipelines(const device& on, VkRenderPass pass, const std::vector<bin>& bins);

  VkDescriptorSetLayout scene_set() const { return scene_set_.get(); }  // 0: draws, materials, textures
  VkDescriptorSetLayout cull_set() const { return cull_set_.get(); }    // 1: clusters, input, commands, counts, bins
  VkPipelineLayout draw_layout() const { return draw_layout_.get(); }   // with draw_constants
  VkPipelineLayout cull_layout() const { return cull_layout_.get(); }   // with cull_constants

  VkPipeline of_bin(std::size_t bin) const { return of_bin_[bin].get(); }
  VkPipeline clusters() const { return clusters_.get(); }
  VkPipeline commands() const { return commands_.get(); }

 private:
  owned_set_layout scene_set_, cull_set_;
  owned_pipeline_layout draw_layout_, cull_layout_;
  std::vector<owned_pipeline> of_bin_;
  owned_pipeline clusters_, commands_;
};

}  // namespace vulkan_host
