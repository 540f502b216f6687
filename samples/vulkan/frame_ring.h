#pragma once
// Two frames in flight: while the device draws one, the host fills the buffers of the other. All that the host writes
// for a frame exists twice.
#include <vulkan/vulkan.h>

#include <array>
#include <cstdint>

#include "device.h"
#include "memory.h"
#include "owned.h"

namespace vulkan_host {

inline constexpr std::size_t frames_in_flight = 2;

struct frame {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  owned_command_pool pool;
  owned_fence done;
  owned_semaphore acquired;  // for a window: the image of the swapchain may be written

  // Written by the host, and the revision of the set that they hold.
  buffer raw_commands, bits;
  std::uint32_t raw_count = 0, raw_revision = 0, bits_revision = 0;

  // Written by the culling shaders.
  buffer drawn_commands, counts;
  buffer counts_back;  // the copy of `counts` that the host reads when the frame has ended
  VkDescriptorSet command_set = VK_NULL_HANDLE, cluster_set = VK_NULL_HANDLE;
  bool counts_wanted = false;
};

class frame_ring {
 public:
  explicit frame_ring(const device& on);
  ~frame_ring();  // waits for the device
  frame_ring(const frame_ring&) = delete;
  frame_ring& operator=(const frame_ring&) = delete;

  std::array<frame, frames_in_flight>& frames() { return frames_; }

  // The next frame, after the device has ended with it: its command buffer may be recorded, its buffers written.
  frame& next();

  // Begins to record the commands of a frame.
  static void begin(const frame& f);

  // Ends recording and submits. wait, signal: for a window, else VK_NULL_HANDLE.
  void submit(const frame& f, VkSemaphore wait, VkSemaphore signal) const;

 private:
  const device& device_;
  std::array<frame, frames_in_flight> frames_;
  std::size_t next_ = 0;
};

}  // namespace vulkan_host
