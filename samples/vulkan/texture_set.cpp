#include "texture_set.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <string>

#include "sightcell/base/error.h"
#include "sightcell/scene/image.h"

namespace vulkan_host {
namespace {

namespace scene = sightcell::scene;

constexpr VkImageAspectFlags color = VK_IMAGE_ASPECT_COLOR_BIT;
constexpr VkFormat format = VK_FORMAT_R8G8B8A8_SRGB;
constexpr std::uint32_t most_side = 512;  // texels

constexpr image_change to_source{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                 VK_PIPELINE_STAGE_TRANSFER_BIT,       VK_PIPELINE_STAGE_TRANSFER_BIT,
                                 VK_ACCESS_TRANSFER_WRITE_BIT,         VK_ACCESS_TRANSFER_READ_BIT};
constexpr image_change from_nothing{VK_IMAGE_LAYOUT_UNDEFINED,
                                    VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                    VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                                    VK_PIPELINE_STAGE_TRANSFER_BIT,
                                    0,
                                    VK_ACCESS_TRANSFER_WRITE_BIT};

// The power of two that the largest image fits into.
std::uint32_t side_of(const scene::scene& s, const std::vector<std::uint32_t>& images) {
  std::uint32_t longest = 1;
  for (const std::uint32_t i : images) {
    const auto size = i < s.images.size() ? scene::size_of(s.images[i].encoded) : std::nullopt;
    if (size) longest = std::max({longest, size->width, size->height});
  }
  return std::min(std::bit_ceil(longest), most_side);
}

VkOffset3D corner_of(std::uint32_t width, std::uint32_t height) {
  return {static_cast<std::int32_t>(width), static_cast<std::int32_t>(height), 1};
}

// Resizes an image into a layer of the array.
void upload_layer(const device& on, const scene::image_pixels& pixels, VkImage array, std::uint32_t side,
                  std::uint32_t layer) {
  const image original(on, {pixels.width, pixels.height}, format,
                       VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_SAMPLED_BIT,
                       color);
  const buffer staging(on, pixels.rgba.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, memory_use::upload);
  std::memcpy(staging.mapped<std::uint8_t>().data(), pixels.rgba.data(), pixels.rgba.size());
  on.run([&](VkCommandBuffer commands) {
    change_layout(commands, original.get(), color, from_nothing);
    const VkBufferImageCopy copy{.imageSubresource = {color, 0, 0, 1}, .imageExtent = {pixels.width, pixels.height, 1}};
    vkCmdCopyBufferToImage(commands, staging.get(), original.get(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    change_layout(commands, original.get(), color, to_source);
    const VkImageBlit whole{.srcSubresource = {color, 0, 0, 1},
                            .srcOffsets = {{}, corner_of(pixels.width, pixels.height)},
                            .dstSubresource = {color, 0, layer, 1},
                            .dstOffsets = {{}, corner_of(side, side)}};
    vkCmdBlitImage(commands, original.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, array,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &whole, VK_FILTER_LINEAR);
  });
}

// Each level from the one before it, of all layers.
void record_levels(VkCommandBuffer commands, VkImage of, std::uint32_t side, std::uint32_t levels,
                   std::uint32_t layers) {
  for (std::uint32_t level = 1; level < levels; ++level) {
    change_layout(commands, of, color, to_source, level - 1);
    const std::uint32_t from = side >> (level - 1), to = side >> level;
    const VkImageBlit half{.srcSubresource = {color, level - 1, 0, layers},
                           .srcOffsets = {{}, corner_of(from, from)},
                           .dstSubresource = {color, level, 0, layers},
                           .dstOffsets = {{}, corner_of(to, to)}};
    vkCmdBlitImage(commands, of, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, of, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                   &half, VK_FILTER_LINEAR);
  }
  change_layout(commands, of, color, to_source, levels - 1);
  change_layout(
      commands, of, color,
      {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_PIPELINE_STAGE_TRANSFER_BIT,
       VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_SHADER_READ_BIT},
      0, levels);
}

}  // namespace

texture_set::texture_set(const device& on, const scene::scene& s, const std::vector<std::uint32_t>& images) {
  const VkPhysicalDeviceLimits& limits = on.limits();
  const auto layers = static_cast<std::uint32_t>(images.size());
  if (layers > limits.maxImageArrayLayers) {
    throw sightcell::error(sightcell::error_kind::failed, "vulkan.limit", on.name(),
                           "has no room for the " + std::to_string(layers) + " textures of " + s.name,
                           "take a scene with fewer images");
  }
  const std::uint32_t side = side_of(s, images), levels = static_cast<std::uint32_t>(std::bit_width(side));
  array_ = image(on, {side, side}, format,
                 VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT, color,
                 levels, layers);
  on.run([&](VkCommandBuffer commands) { change_layout(commands, array_.get(), color, from_nothing, 0, levels); });
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    std::optional<scene::image_pixels> pixels;
    if (images[layer] < s.images.size()) pixels = scene::decode(s.images[images[layer]], limits.maxImageDimension2D);
    if (!pixels) pixels = scene::image_pixels{1, 1, {255, 255, 255, 255}};
    upload_layer(on, *pixels, array_.get(), side, layer);
  }
  on.run([&](VkCommandBuffer commands) { record_levels(commands, array_.get(), side, levels, layers); });
  const VkSamplerCreateInfo info{.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                 .magFilter = VK_FILTER_LINEAR,
                                 .minFilter = VK_FILTER_LINEAR,
                                 .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                 .maxLod = VK_LOD_CLAMP_NONE};  // repeats; the shader does the other wrap modes
  sampler_ = make<owned_sampler>(on.get(), vkCreateSampler, info, "vkCreateSampler");
}

}  // namespace vulkan_host
