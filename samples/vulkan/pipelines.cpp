#include "pipelines.h"

#include <array>
#include <cstddef>
#include <span>

#include "gpu_records.h"
#include "spirv/clusters_comp.h"
#include "spirv/commands_comp.h"
#include "spirv/scene_frag.h"
#include "spirv/scene_vert.h"

namespace vulkan_host {
namespace {

constexpr VkShaderStageFlags drawing = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
constexpr VkShaderStageFlags culling = VK_SHADER_STAGE_COMPUTE_BIT;

VkDescriptorSetLayoutBinding storage(std::uint32_t binding, VkShaderStageFlags stages) {
  return {.binding = binding,
          .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
          .descriptorCount = 1,
          .stageFlags = stages};
}

owned_set_layout make_set_layout(const device& on, std::span<const VkDescriptorSetLayoutBinding> bindings) {
  const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                             .bindingCount = static_cast<std::uint32_t>(bindings.size()),
                                             .pBindings = bindings.data()};
  return make<owned_set_layout>(on.get(), vkCreateDescriptorSetLayout, info, "vkCreateDescriptorSetLayout");
}

owned_pipeline_layout make_layout(const device& on, std::span<const VkDescriptorSetLayout> sets,
                                  const VkPushConstantRange& constants) {
  const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .setLayoutCount = static_cast<std::uint32_t>(sets.size()),
                                        .pSetLayouts = sets.data(),
                                        .pushConstantRangeCount = 1,
                                        .pPushConstantRanges = &constants};
  return make<owned_pipeline_layout>(on.get(), vkCreatePipelineLayout, info, "vkCreatePipelineLayout");
}

owned_shader make_shader(const device& on, std::span<const std::uint32_t> spirv) {
  const VkShaderModuleCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = spirv.size_bytes(), .pCode = spirv.data()};
  return make<owned_shader>(on.get(), vkCreateShaderModule, info, "vkCreateShaderModule");
}

VkPipelineShaderStageCreateInfo stage_of(VkShaderStageFlagBits stage, const owned_shader& shader,
                                         const VkSpecializationInfo* constants = nullptr) {
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
          .stage = stage,
          .module = shader.get(),
          .pName = "main",
          .pSpecializationInfo = constants};
}

owned_pipeline make_compute(const device& on, VkPipelineLayout layout, std::span<const std::uint32_t> spirv) {
  const owned_shader shader = make_shader(on, spirv);
  const VkComputePipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                         .stage = stage_of(VK_SHADER_STAGE_COMPUTE_BIT, shader),
                                         .layout = layout};
  VkPipeline made = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(on.get(), VK_NULL_HANDLE, 1, &info, nullptr, &made), "vkCreateComputePipelines");
  return {on.get(), made};
}

// What all bins have in common, and what they change of it.
struct graphics_state {
  VkVertexInputBindingDescription binding{0, sizeof(vertex), VK_VERTEX_INPUT_RATE_VERTEX};
  std::array<VkVertexInputAttributeDescription, 3> attributes{
      VkVertexInputAttributeDescription{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(vertex, position)},
      VkVertexInputAttributeDescription{1, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(vertex, uv)},
      VkVertexInputAttributeDescription{2, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(vertex, tint)}};
  VkPipelineVertexInputStateCreateInfo vertices{.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
                                                .vertexBindingDescriptionCount = 1,
                                                .pVertexBindingDescriptions = &binding,
                                                .vertexAttributeDescriptionCount = 3,
                                                .pVertexAttributeDescriptions = attributes.data()};
  VkPipelineInputAssemblyStateCreateInfo assembly{.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
                                                  .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  VkPipelineViewportStateCreateInfo viewport{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
  VkPipelineRasterizationStateCreateInfo raster{.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
                                                .lineWidth = 1.0f};
  VkPipelineMultisampleStateCreateInfo samples{.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                               .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  VkPipelineDepthStencilStateCreateInfo depth{.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                              .depthTestEnable = VK_TRUE,
                                              .depthCompareOp = VK_COMPARE_OP_GREATER};  // reversed: larger is nearer
  VkPipelineColorBlendAttachmentState mixing{.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
                                             .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
                                             .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                             .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
                                             .colorWriteMask = 0xF};
  VkPipelineColorBlendStateCreateInfo blend{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO, .attachmentCount = 1, .pAttachments = &mixing};
  std::array<VkDynamicState, 2> changing{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                           .dynamicStateCount = 2,
                                           .pDynamicStates = changing.data()};

  explicit graphics_state(const bin& b) {
    raster.cullMode = b.faces == facing::both ? VK_CULL_MODE_NONE : VK_CULL_MODE_BACK_BIT;
    raster.frontFace = b.faces == facing::mirrored ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE;
    depth.depthWriteEnable = b.is_blended() ? VK_FALSE : VK_TRUE;
    mixing.blendEnable = b.is_blended() ? VK_TRUE : VK_FALSE;
  }
  graphics_state(const graphics_state&) = delete;  // its members point at each other
  graphics_state& operator=(const graphics_state&) = delete;
};

owned_pipeline make_graphics(const device& on, VkRenderPass pass, VkPipelineLayout layout, const bin& b,
                             const owned_shader& vertex_shader, const owned_shader& fragment_shader) {
  const auto alpha = static_cast<std::uint32_t>(b.alpha);
  const VkSpecializationMapEntry entry{0, 0, sizeof alpha};
  const VkSpecializationInfo constants{1, &entry, sizeof alpha, &alpha};
  const VkPipelineShaderStageCreateInfo stages[] = {
      stage_of(VK_SHADER_STAGE_VERTEX_BIT, vertex_shader),
      stage_of(VK_SHADER_STAGE_FRAGMENT_BIT, fragment_shader, &constants)};
  const graphics_state state(b);
  const VkGraphicsPipelineCreateInfo info{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                          .stageCount = 2,
                                          .pStages = stages,
                                          .pVertexInputState = &state.vertices,
                                          .pInputAssemblyState = &state.assembly,
                                          .pViewportState = &state.viewport,
                                          .pRasterizationState = &state.raster,
                                          .pMultisampleState = &state.samples,
                                          .pDepthStencilState = &state.depth,
                                          .pColorBlendState = &state.blend,
                                          .pDynamicState = &state.dynamic,
                                          .layout = layout,
                                          .renderPass = pass};
  VkPipeline made = VK_NULL_HANDLE;
  check(vkCreateGraphicsPipelines(on.get(), VK_NULL_HANDLE, 1, &info, nullptr, &made), "vkCreateGraphicsPipelines");
  return {on.get(), made};
}

}  // namespace

pipelines::pipelines(const device& on, VkRenderPass pass, const std::vector<bin>& bins) {
  const VkDescriptorSetLayoutBinding scene_bindings[] = {
      storage(0, drawing | culling), storage(1, drawing | culling),
      VkDescriptorSetLayoutBinding{.binding = 2,
                                   .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                   .descriptorCount = 1,
                                   .stageFlags = VK_SHADER_STAGE_FRAGMENT_BIT}};
  const VkDescriptorSetLayoutBinding cull_bindings[] = {storage(0, culling), storage(1, culling), storage(2, culling),
                                                        storage(3, culling), storage(4, culling)};
  scene_set_ = make_set_layout(on, scene_bindings);
  cull_set_ = make_set_layout(on, cull_bindings);
  const VkDescriptorSetLayout sets[] = {scene_set_.get(), cull_set_.get()};
  draw_layout_ = make_layout(on, std::span(sets).first(1), {drawing, 0, sizeof(draw_constants)});
  cull_layout_ = make_layout(on, sets, {culling, 0, sizeof(cull_constants)});

  const owned_shader vertex_shader = make_shader(on, scene_vert), fragment_shader = make_shader(on, scene_frag);
  for (const bin& b : bins) {
    of_bin_.push_back(make_graphics(on, pass, draw_layout_.get(), b, vertex_shader, fragment_shader));
  }
  clusters_ = make_compute(on, cull_layout_.get(), clusters_comp);
  commands_ = make_compute(on, cull_layout_.get(), commands_comp);
}

}  // namespace vulkan_host
