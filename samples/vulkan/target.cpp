#include "target.h"

#include <algorithm>
#include <array>

namespace vulkan_host {
namespace {

constexpr VkFormat color_format = VK_FORMAT_R8G8B8A8_SRGB, depth_format = VK_FORMAT_D32_SFLOAT;
constexpr std::array<float, 3> sky = {0.46f, 0.63f, 0.86f};  // linear; scene.frag has it too

}  // namespace

owned_render_pass make_render_pass(const device& on) {
  const std::array<VkAttachmentDescription, 2> attachments{
      VkAttachmentDescription{.format = color_format,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                              .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                              .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                              .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                              .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                              .finalLayout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
      VkAttachmentDescription{.format = depth_format,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR,
                              .storeOp = VK_ATTACHMENT_STORE_OP_STORE,  // compared by the sample; a game needs it not
                              .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                              .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                              .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                              .finalLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}};
  const VkAttachmentReference color{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass{.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                     .colorAttachmentCount = 1,
                                     .pColorAttachments = &color,
                                     .pDepthStencilAttachment = &depth};
  // All frames share the target: a frame waits until the one before has been drawn and copied.
  constexpr VkPipelineStageFlags tests =
      VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  constexpr VkPipelineStageFlags draws = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | tests;
  constexpr VkAccessFlags writes = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  constexpr VkAccessFlags reads = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT;
  const std::array<VkSubpassDependency, 2> dependencies{
      VkSubpassDependency{.srcSubpass = VK_SUBPASS_EXTERNAL,
                          .dstSubpass = 0,
                          .srcStageMask = draws | VK_PIPELINE_STAGE_TRANSFER_BIT,
                          .dstStageMask = draws,
                          .srcAccessMask = writes,
                          .dstAccessMask = writes | reads},
      VkSubpassDependency{.srcSubpass = 0,
                          .dstSubpass = VK_SUBPASS_EXTERNAL,
                          .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
                          .srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT}};
  const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                    .attachmentCount = attachments.size(),
                                    .pAttachments = attachments.data(),
                                    .subpassCount = 1,
                                    .pSubpasses = &subpass,
                                    .dependencyCount = dependencies.size(),
                                    .pDependencies = dependencies.data()};
  return make<owned_render_pass>(on.get(), vkCreateRenderPass, info, "vkCreateRenderPass");
}

target::target(const device& on, VkRenderPass pass, VkExtent2D size)
    : size_(size),
      pass_(pass),
      color_(on, size, color_format, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
             VK_IMAGE_ASPECT_COLOR_BIT),
      depth_(on, size, depth_format, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
             VK_IMAGE_ASPECT_DEPTH_BIT) {
  const VkImageView views[] = {color_.view(), depth_.view()};
  const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = pass,
                                     .attachmentCount = 2,
                                     .pAttachments = views,
                                     .width = size.width,
                                     .height = size.height,
                                     .layers = 1};
  framebuffer_ = make<owned_framebuffer>(on.get(), vkCreateFramebuffer, info, "vkCreateFramebuffer");
}

void target::begin_pass(VkCommandBuffer commands) const {
  std::array<VkClearValue, 2> clear{};
  clear[0].color = {{sky[0], sky[1], sky[2], 0.0f}};
  clear[1].depthStencil = {0.0f, 0};  // infinitely far
  const VkRenderPassBeginInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = pass_,
                                   .framebuffer = framebuffer_.get(),
                                   .renderArea = {{0, 0}, size_},
                                   .clearValueCount = clear.size(),
                                   .pClearValues = clear.data()};
  vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport{0.0f, 0.0f, static_cast<float>(size_.width), static_cast<float>(size_.height), 0.0f, 1.0f};
  const VkRect2D scissor{{0, 0}, size_};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &scissor);
}

picture target::read_back(const device& on) const {
  const std::size_t pixels = std::size_t{size_.width} * size_.height;
  const buffer colors(on, 4 * pixels, VK_BUFFER_USAGE_TRANSFER_DST_BIT, memory_use::read_back);
  const buffer depths(on, 4 * pixels, VK_BUFFER_USAGE_TRANSFER_DST_BIT, memory_use::read_back);
  on.run([&](VkCommandBuffer commands) {
    change_layout(commands, depth_.get(), VK_IMAGE_ASPECT_DEPTH_BIT,
                  {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                   VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT});
    VkBufferImageCopy whole{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                            .imageExtent = {size_.width, size_.height, 1}};
    vkCmdCopyImageToBuffer(commands, color_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, colors.get(), 1, &whole);
    whole.imageSubresource.aspectMask = VK_IMAGE_ASPECT_DEPTH_BIT;
    vkCmdCopyImageToBuffer(commands, depth_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, depths.get(), 1, &whole);
    const VkMemoryBarrier to_host{.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                  .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                  .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0,
                         nullptr, 0, nullptr);
  });
  const auto rgba = colors.mapped<std::uint8_t>().first(4 * pixels);
  const auto depth = depths.mapped<float>().first(pixels);
  return {size_, {rgba.begin(), rgba.end()}, {depth.begin(), depth.end()}};
}

}  // namespace vulkan_host
