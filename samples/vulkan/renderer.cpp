#include "renderer.h"

#include <algorithm>
#include <array>
#include <vector>

#include "cpu_time.h"
#include "sightcell/base/error.h"

namespace vulkan_host {
namespace {

constexpr VkBufferUsageFlags storage_use = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
constexpr VkDeviceSize command_bytes = sizeof(VkDrawIndexedIndirectCommand);
constexpr std::uint32_t group_size = 64;  // of both culling shaders

static_assert(sizeof(sightcell_command) == sizeof(VkDrawIndexedIndirectCommand));

bool fills_on_device(draw_mode mode) {
  return mode == draw_mode::commands || mode == draw_mode::clusters;
}

void wait_for(VkCommandBuffer commands, VkPipelineStageFlags after, VkAccessFlags written, VkPipelineStageFlags before,
              VkAccessFlags read) {
  const VkMemoryBarrier barrier{
      .sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER, .srcAccessMask = written, .dstAccessMask = read};
  vkCmdPipelineBarrier(commands, after, before, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

// Slots of a bin for clusters are those of its clusters. Those for commands have room for all commands of any set.
// Blended bins keep their order, so they are not compacted: that would draw them in another order in each frame.
std::vector<bin_record> bin_table(const device& on, const host_scene& host, std::optional<std::uint32_t> room) {
  std::vector<bin_record> out;
  std::uint32_t most = room.value_or(0);
  for (const bin& b : host.bins) {
    const std::uint32_t first = room ? *room * static_cast<std::uint32_t>(out.size()) : b.first_cluster;
    out.push_back({first, on.counts() && !b.is_blended() ? 1u : 0u});
    most = std::max(most, b.cluster_count);
  }
  if (most > on.limits().maxDrawIndirectCount) {
    throw sightcell::error(sightcell::error_kind::failed, "vulkan.limit", on.name(),
                           "cannot draw " + std::to_string(most) + " indirect commands at once",
                           "take a device with a larger maxDrawIndirectCount");
  }
  return out;
}

bool is_in_frustum(const std::array<glm::vec4, 5>& planes, const glm::vec3& eye, const glm::vec4& sphere) {
  const glm::vec3 from_eye = glm::vec3(sphere) - eye;
  return std::all_of(planes.begin(), planes.end(),
                     [&](const glm::vec4& p) { return glm::dot(glm::vec3(p), from_eye) >= -sphere.w; });
}

}  // namespace

// ---- making ----

renderer::renderer(const device& on, const sightcell::scene::scene& s, const host_scene& host, visibility& visible,
                   VkExtent2D size)
    : device_(on),
      host_(host),
      visible_(visible),
      textures_(on, s, host.textures),
      pass_(make_render_pass(on)),
      pipelines_(on, pass_.get(), host.bins),
      target_(std::in_place, on, pass_.get(), size),
      vertices_(upload_buffer(on, std::span(host.vertices), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT)),
      own_indices_(upload_buffer(on, std::span(host.own_indices), VK_BUFFER_USAGE_INDEX_BUFFER_BIT)),
      stored_indices_(upload_buffer(on, std::span(host.stored_indices), VK_BUFFER_USAGE_INDEX_BUFFER_BIT)),
      draws_(upload_buffer(on, std::span(host.draws), storage_use)),
      materials_(upload_buffer(on, std::span(host.materials), storage_use)),
      clusters_(upload_buffer(on, std::span(host.clusters), storage_use)),
      cluster_bins_(upload_buffer(on, std::span<const bin_record>(bin_table(on, host, std::nullopt)), storage_use)),
      command_bins_(
          upload_buffer(on, std::span<const bin_record>(bin_table(on, host, visible.most_commands())), storage_use)),
      ring_(on) {
  make_sets(textures_);
  for (frame& f : ring_.frames()) make_frame(f);
}

VkDescriptorSet renderer::make_set(VkDescriptorSetLayout layout) const {
  const VkDescriptorSetAllocateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                         .descriptorPool = descriptors_.get(),
                                         .descriptorSetCount = 1,
                                         .pSetLayouts = &layout};
  VkDescriptorSet made = VK_NULL_HANDLE;
  check(vkAllocateDescriptorSets(device_.get(), &info, &made), "vkAllocateDescriptorSets");
  return made;
}

namespace {

// Storage buffers of a set, from binding 0 on.
void write_set(const device& on, VkDescriptorSet set, std::span<const buffer* const> buffers) {
  std::vector<VkDescriptorBufferInfo> infos;
  for (const buffer* b : buffers) infos.push_back({b->get(), 0, VK_WHOLE_SIZE});
  const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .dstSet = set,
                                   .descriptorCount = static_cast<std::uint32_t>(infos.size()),
                                   .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                   .pBufferInfo = infos.data()};
  vkUpdateDescriptorSets(on.get(), 1, &write, 0, nullptr);  // the array continues in the next bindings
}

}  // namespace

void renderer::make_sets(const texture_set& textures) {
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2 + 2 * 5 * frames_in_flight},
                                        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1}};
  const VkDescriptorPoolCreateInfo pool{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                        .maxSets = 1 + 2 * frames_in_flight,
                                        .poolSizeCount = 2,
                                        .pPoolSizes = sizes};
  descriptors_ = make<owned_descriptor_pool>(device_.get(), vkCreateDescriptorPool, pool, "vkCreateDescriptorPool");
  scene_set_ = make_set(pipelines_.scene_set());
  const buffer* const of_scene[] = {&draws_, &materials_};
  write_set(device_, scene_set_, of_scene);
  const VkDescriptorImageInfo info = textures.descriptor();
  const VkWriteDescriptorSet write{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .dstSet = scene_set_,
                                   .dstBinding = 2,
                                   .descriptorCount = 1,
                                   .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                   .pImageInfo = &info};
  vkUpdateDescriptorSets(device_.get(), 1, &write, 0, nullptr);
}

void renderer::make_frame(frame& f) {
  const std::size_t bins = host_.bins.size();
  const VkDeviceSize slots = std::max<VkDeviceSize>(host_.clusters.size(), bins * visible_.most_commands());
  f.raw_commands = buffer(device_, command_bytes * visible_.most_commands(), storage_use, memory_use::upload);
  f.bits = buffer(device_, sizeof(std::uint32_t) * visible_.words(), storage_use, memory_use::upload);
  f.drawn_commands =
      buffer(device_, command_bytes * slots, storage_use | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, memory_use::device);
  f.counts = buffer(device_, sizeof(std::uint32_t) * (bins + 2),
                    storage_use | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                        VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                    memory_use::device);
  f.counts_back = buffer(device_, f.counts.bytes(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, memory_use::read_back);
  f.cluster_set = make_set(pipelines_.cull_set());
  const buffer* const of_clusters[] = {&clusters_, &f.bits, &f.drawn_commands, &f.counts, &cluster_bins_};
  write_set(device_, f.cluster_set, of_clusters);
  f.command_set = make_set(pipelines_.cull_set());
  const buffer* const of_commands[] = {&clusters_, &f.raw_commands, &f.drawn_commands, &f.counts, &command_bins_};
  write_set(device_, f.command_set, of_commands);
}

void renderer::resize(VkExtent2D size) {
  finish();
  target_.emplace(device_, pass_.get(), size);
}

// ---- a frame ----

frame& renderer::draw(const camera& view, draw_mode mode) {
  frame& f = ring_.next();
  collect(f);
  const double begin = thread_milliseconds();
  check(vkResetCommandPool(device_.get(), f.pool.get(), 0), "vkResetCommandPool");
  frame_ring::begin(f);
  if (fills_on_device(mode)) fill(f, view, mode);
  record_pass(f, view, mode);
  f.counts_wanted = fills_on_device(mode);
  if (f.counts_wanted) {
    const VkBufferCopy whole{.size = f.counts.bytes()};
    vkCmdCopyBuffer(f.commands, f.counts.get(), f.counts_back.get(), 1, &whole);
    wait_for(f.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
             VK_ACCESS_HOST_READ_BIT);
  }
  ++effort_.frames;
  effort_.host_milliseconds += thread_milliseconds() - begin;
  return f;
}

// What the device counted when it drew this frame the last time.
void renderer::collect(frame& f) {
  if (!f.counts_wanted) return;
  const auto counts = f.counts_back.mapped<const std::uint32_t>();
  effort_.draws += counts[host_.bins.size()];
  effort_.triangles += counts[host_.bins.size() + 1];
  f.counts_wanted = false;
}

// Writes the set of the camera's cell into the buffer of this frame, and lets a shader make the commands of it.
void renderer::fill(frame& f, const camera& view, draw_mode mode) {
  visible_.move({view.eye.x, view.eye.y, view.eye.z});
  const bool by_clusters = mode == draw_mode::clusters;
  std::uint32_t& revision = by_clusters ? f.bits_revision : f.raw_revision;
  if (revision != visible_.revision()) {  // else what this frame's buffer has still holds
    if (by_clusters) {
      visible_.write_bits(f.bits.mapped<std::uint32_t>());
    } else {
      f.raw_count = visible_.write_commands(f.raw_commands.mapped<sightcell_command>());
    }
    revision = visible_.revision();
  }

  const std::uint32_t count = by_clusters ? static_cast<std::uint32_t>(host_.clusters.size()) : f.raw_count;
  const cull_constants constants{glm::vec4(view.eye, 0.0f), view.planes(), count,
                                 static_cast<std::uint32_t>(host_.bins.size())};
  vkCmdFillBuffer(f.commands, f.counts.get(), 0, VK_WHOLE_SIZE, 0);
  wait_for(f.commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
           VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
  const VkDescriptorSet sets[] = {scene_set_, by_clusters ? f.cluster_set : f.command_set};
  vkCmdBindPipeline(f.commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                    by_clusters ? pipelines_.clusters() : pipelines_.commands());
  vkCmdBindDescriptorSets(f.commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipelines_.cull_layout(), 0, 2, sets, 0, nullptr);
  vkCmdPushConstants(f.commands, pipelines_.cull_layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants,
                     &constants);
  vkCmdDispatch(f.commands, (count + group_size - 1) / group_size, 1, 1);
  wait_for(f.commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
           VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
           VK_ACCESS_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT);
}

void renderer::record_pass(const frame& f, const camera& view, draw_mode mode) {
  target_->begin_pass(f.commands);
  vkCmdBindDescriptorSets(f.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.draw_layout(), 0, 1, &scene_set_, 0,
                          nullptr);
  const draw_constants constants = view.constants(4.0f * host_.size);
  vkCmdPushConstants(f.commands, pipelines_.draw_layout(), VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                     sizeof constants, &constants);
  const VkBuffer vertices = vertices_.get();
  const VkDeviceSize from = 0;
  vkCmdBindVertexBuffers(f.commands, 0, 1, &vertices, &from);
  // Only the commands of the runtime count in stored order. Clusters are of the host's own order.
  const buffer& indices = mode == draw_mode::commands ? stored_indices_ : own_indices_;
  vkCmdBindIndexBuffer(f.commands, indices.get(), 0, VK_INDEX_TYPE_UINT32);
  if (fills_on_device(mode)) {
    record_indirect(f, mode);
  } else {
    record_whole(f.commands, view, mode == draw_mode::frustum);
  }
  vkCmdEndRenderPass(f.commands);
}

void renderer::record_whole(VkCommandBuffer commands, const camera& view, bool culls) {
  const std::array<glm::vec4, 5> planes = view.planes();
  for (std::size_t b = 0; b < host_.bins.size(); ++b) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.of_bin(b));
    for (const std::uint32_t d :
         std::span(host_.sorted_draws).subspan(host_.bins[b].first_draw, host_.bins[b].draw_count)) {
      if (culls && !is_in_frustum(planes, view.eye, host_.draws[d].sphere)) continue;
      const whole_draw& whole = host_.whole_draws[d];
      vkCmdDrawIndexed(commands, whole.index_count, 1, whole.first_index, host_.draws[d].vertex_offset, d);
      ++effort_.draws;
      effort_.triangles += whole.index_count / 3;
    }
  }
}

void renderer::record_indirect(const frame& f, draw_mode mode) const {
  for (std::size_t b = 0; b < host_.bins.size(); ++b) {
    const bin& own = host_.bins[b];
    const bool by_clusters = mode == draw_mode::clusters;
    const std::uint32_t room = visible_.most_commands();
    const VkDeviceSize first = command_bytes * (by_clusters ? own.first_cluster : b * room);
    vkCmdBindPipeline(f.commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipelines_.of_bin(b));
    if (device_.counts()) {  // for all bins: Mesa 22.3 on the CPU draws nothing if both calls follow each other
      vkCmdDrawIndexedIndirectCount(f.commands, f.drawn_commands.get(), first, f.counts.get(),
                                    sizeof(std::uint32_t) * b, by_clusters ? own.cluster_count : room,
                                    static_cast<std::uint32_t>(command_bytes));
    } else {
      vkCmdDrawIndexedIndirect(f.commands, f.drawn_commands.get(), first, by_clusters ? own.cluster_count : f.raw_count,
                               static_cast<std::uint32_t>(command_bytes));
    }
  }
}

void renderer::submit(const frame& f, VkSemaphore wait, VkSemaphore signal) {
  ring_.submit(f, wait, signal);
}

void renderer::finish() {
  for (std::size_t i = 0; i < frames_in_flight; ++i) collect(ring_.next());
}

effort renderer::take_effort() {
  return std::exchange(effort_, effort{});
}

}  // namespace vulkan_host
