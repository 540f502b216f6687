#pragma once
// The draw paths. Frames are drawn one after the other: draw, perhaps more commands into the frame, submit.
#include <vulkan/vulkan.h>

#include <cstdint>
#include <optional>
#include <span>

#include "camera.h"
#include "device.h"
#include "frame_ring.h"
#include "host_scene.h"
#include "memory.h"
#include "owned.h"
#include "pipelines.h"
#include "target.h"
#include "texture_set.h"
#include "visibility.h"

namespace vulkan_host {

enum class draw_mode : std::uint8_t {
  everything,  // each draw, whole
  frustum,     // each draw in the frustum, whole: what an engine does without a PVS
  commands,    // the polygons of the set, as indirect commands of the runtime; draws tested against the frustum
  clusters     // the host's clusters with a polygon in the set; clusters tested against the frustum
};

// Sums over frames that have ended.
struct effort {
  std::uint64_t frames = 0, draws = 0, triangles = 0;
  double host_milliseconds = 0.0;  // CPU time of the host for a frame: moving the view, filling buffers, recording
};

class renderer {
 public:
  // on, visible: must outlive the object. s: used during the constructor only. The host's arrays are copied to the
  // device; of host, the bins, the draws and their spheres are used afterwards, so it must outlive the object.
  renderer(const device& on, const sightcell::scene::scene& s, const host_scene& host, visibility& visible,
           VkExtent2D size);

  // Waits for a frame of the ring and records all of it, up to the picture in target().
  frame& draw(const camera& view, draw_mode mode);
  void submit(const frame& f, VkSemaphore wait = VK_NULL_HANDLE, VkSemaphore signal = VK_NULL_HANDLE);

  // Waits until all frames have ended.
  void finish();

  void resize(VkExtent2D size);
  const target& picture_target() const { return *target_; }

  // Efforts since the last call. Those of frames that have not ended are in the next one.
  effort take_effort();

 private:
  void make_sets(const texture_set& textures);
  void make_frame(frame& f);
  VkDescriptorSet make_set(VkDescriptorSetLayout layout) const;
  void collect(frame& f);
  void fill(frame& f, const camera& view, draw_mode mode);
  void record_whole(VkCommandBuffer commands, const camera& view, bool culls);
  void record_indirect(const frame& f, draw_mode mode) const;
  void record_pass(const frame& f, const camera& view, draw_mode mode);

  const device& device_;
  const host_scene& host_;
  visibility& visible_;
  texture_set textures_;
  owned_render_pass pass_;
  pipelines pipelines_;
  std::optional<target> target_;
  buffer vertices_, own_indices_, stored_indices_, draws_, materials_, clusters_, cluster_bins_, command_bins_;
  owned_descriptor_pool descriptors_;
  VkDescriptorSet scene_set_ = VK_NULL_HANDLE;
  effort effort_;
  frame_ring ring_;  // the last member: its destructor waits for the device
};

}  // namespace vulkan_host
