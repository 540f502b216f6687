#include "renderer.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "gpu_driven_shaders/sources.h"
#include "texture_array.h"

namespace gpu_driven {
namespace {

constexpr std::uint32_t group_size = 64;  // of cull.comp
constexpr std::size_t command_bytes = sizeof(draw_command);

// Uniforms.
namespace of_cull {
constexpr GLint stage = 0, uses_bits = 1, cluster_count = 2, bin_count = 3, most_pixels = 4;
}
namespace of_blended {
constexpr GLint marks = 0;
}

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);
}

std::vector<GLuint> color_outputs(const gl_texture& color, const gl_texture& ids) {
  if (ids.id() == 0) return {color.id()};
  return {color.id(), ids.id()};
}

// Blended bins keep their order, so they are not compacted: that would draw them in another order in each frame.
std::vector<bin_record> bin_table(const host_scene& host, bool counts) {
  std::vector<bin_record> out;
  for (const bin& b : host.bins) out.push_back({b.first_cluster, counts && !b.is_blended() ? 1u : 0u});
  return out;
}

// Counts of the bins that are not compacted do not change. all: those of all bins, for drawing everything.
std::vector<std::uint32_t> fixed_counts(const host_scene& host, bool all) {
  std::vector<std::uint32_t> out;
  for (int region = 0; region < 2; ++region) {
    for (const bin& b : host.bins) out.push_back(all || b.is_blended() ? b.cluster_count : 0);
  }
  return out;
}

std::vector<draw_command> whole_commands(const host_scene& host) {
  std::vector<draw_command> out;
  for (const cluster_record& c : host.clusters)
    out.push_back({c.index_count, 1, c.first_index, c.base_vertex, static_cast<std::uint32_t>(out.size())});
  return out;
}

}  // namespace

target::target(int width, int height, bool has_ids)
    : color(GL_SRGB8_ALPHA8, width, height),
      depth(GL_DEPTH_COMPONENT32F, width, height),
      ids(has_ids ? gl_texture(GL_R32UI, width, height) : gl_texture()),
      framebuffer(color_outputs(color, ids), depth.id()) {}

// ---- making ----

renderer::renderer(const sightcell::scene::scene& s, const host_scene& host, const settings& wanted)
    : host_(host),
      settings_(wanted),
      counts_(wanted.may_count && epoxy_has_gl_extension("GL_ARB_indirect_parameters")),
      textures_(make_texture_array(s, host.textures)),
      vertices_(host.vertices),
      indices_(host.indices),
      instances_(host.instances),
      materials_(host.materials),
      clusters_(host.clusters),
      levels_(host.level_groups),
      bins_(bin_table(host, counts_)),
      all_commands_(whole_commands(host)),
      all_counts_(fixed_counts(host, true)),
      first_counts_(fixed_counts(host, false)),
      commands_(2 * host.clusters.size() * command_bytes, nullptr),
      command_counts_(2 * host.bins.size() * sizeof(std::uint32_t), nullptr),
      view_(sizeof(camera_record), nullptr, GL_DYNAMIC_STORAGE_BIT),
      last_view_(sizeof(camera_record), nullptr),
      seen_(host.clusters.size() * sizeof(std::uint32_t), nullptr),
      full_(wanted.width, wanted.height, true),
      shared_(wanted.width, wanted.height, false),
      own_depth_(wanted.width, wanted.height),
      last_depth_(wanted.width, wanted.height),
      cull_("cull", {{GL_COMPUTE_SHADER, shaders::cull_comp}}),
      opaque_("opaque", {{GL_VERTEX_SHADER, shaders::cluster_vert}, {GL_FRAGMENT_SHADER, shaders::opaque_frag}}),
      masked_("masked", {{GL_VERTEX_SHADER, shaders::cluster_vert}, {GL_FRAGMENT_SHADER, shaders::masked_frag}}),
      blended_("blended", {{GL_VERTEX_SHADER, shaders::cluster_vert}, {GL_FRAGMENT_SHADER, shaders::blended_frag}}) {
  for (state& each : states_) {
    each.drawn = gl_buffer(host.clusters.size() * sizeof(std::uint32_t), nullptr);
    each.history = gl_buffer(host.clusters.size() * sizeof(std::uint32_t), nullptr);
  }
  make_vertex_array();
  glProgramUniform1ui(cull_.id(), of_cull::cluster_count, static_cast<GLuint>(host.clusters.size()));
  glProgramUniform1ui(cull_.id(), of_cull::bin_count, static_cast<GLuint>(host.bins.size()));
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glEnable(GL_FRAMEBUFFER_SRGB);
  // The target's alpha: the sum of all that was blended.
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE);
}

renderer::~renderer() {
  glDeleteVertexArrays(1, &vertex_array_);
}

void renderer::make_vertex_array() {
  glCreateVertexArrays(1, &vertex_array_);
  glVertexArrayElementBuffer(vertex_array_, indices_.id());
  glVertexArrayVertexBuffer(vertex_array_, 0, vertices_.id(), 0, sizeof(vertex));
  glVertexArrayVertexBuffer(vertex_array_, 1, instances_.id(), 0, sizeof(instance_record));
  glVertexArrayBindingDivisor(vertex_array_, 1, 1);
  const auto add = [&](GLuint attribute, GLuint binding) {
    glEnableVertexArrayAttrib(vertex_array_, attribute);
    glVertexArrayAttribBinding(vertex_array_, attribute, binding);
  };
  for (GLuint attribute = 0; attribute < 7; ++attribute) add(attribute, attribute < 3 ? 0 : 1);
  glVertexArrayAttribFormat(vertex_array_, 0, 3, GL_FLOAT, GL_FALSE, offsetof(vertex, position));
  glVertexArrayAttribFormat(vertex_array_, 1, 2, GL_FLOAT, GL_FALSE, offsetof(vertex, uv));
  glVertexArrayAttribFormat(vertex_array_, 2, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(vertex, tint));
  for (GLuint row = 0; row < 3; ++row)
    glVertexArrayAttribFormat(vertex_array_, 3 + row, 4, GL_FLOAT, GL_FALSE, row * sizeof(glm::vec4));
  glVertexArrayAttribIFormat(vertex_array_, 6, 2, GL_UNSIGNED_INT, offsetof(instance_record, cluster));
}

// ---- a frame ----

void renderer::begin(const camera& view) {
  const camera_record record =
      record_of(view, static_cast<float>(settings_.width), static_cast<float>(settings_.height), 4.0f * host_.size);
  view_.write(std::span<const camera_record>(&record, 1));
}

void renderer::draw(draw_mode mode, const visibility* visible) {
  view_.bind(GL_UNIFORM_BUFFER, 0);
  if (mode == draw_mode::everything) return draw_everything();
  const bool has_two = mode == draw_mode::two_pass || mode == draw_mode::pvs_two_pass;
  begin_commands();
  cull(mode,
       has_two                         ? stage::first_of_two
       : mode == draw_mode::last_frame ? stage::last_depth
                                       : stage::without_depth,
       visible);
  begin_pass(shared_);
  draw_bins(0, false);
  if (!has_two) {
    draw_bins(0, true);
    if (mode == draw_mode::last_frame) remember_depth();
    return;
  }
  own_depth_.build(shared_.depth);
  cull(mode, stage::second_of_two, visible);
  draw_bins(1, false);
  draw_bins(1, true);  // what is blended is never in the first pass
}

void renderer::begin_commands() const {
  glCopyNamedBufferSubData(first_counts_.id(), command_counts_.id(), 0, 0,
                           static_cast<GLsizeiptr>(2 * host_.bins.size() * sizeof(std::uint32_t)));
}

void renderer::cull(draw_mode mode, stage which, const visibility* visible) {
  const state& own = states_[static_cast<std::size_t>(mode)];
  const bool is_last = which == stage::last_depth;
  (is_last ? last_view_ : view_).bind(GL_UNIFORM_BUFFER, 1);
  clusters_.bind_storage(0);
  (visible != nullptr ? visible->bits() : own.drawn).bind_storage(1);  // something has to be bound
  own.history.bind_storage(2);
  own.drawn.bind_storage(3);
  commands_.bind_storage(4);
  command_counts_.bind_storage(5);
  bins_.bind_storage(6);
  levels_.bind_storage(7);
  glBindTextureUnit(0, (is_last ? last_depth_ : own_depth_).texture().id());
  glProgramUniform1ui(cull_.id(), of_cull::stage, static_cast<GLuint>(which));
  glProgramUniform1ui(cull_.id(), of_cull::uses_bits, visible != nullptr ? 1 : 0);
  glProgramUniform1f(cull_.id(), of_cull::most_pixels,
                     has_levels() && mode != draw_mode::leaves ? settings_.most_pixels : -1.0f);
  glUseProgram(cull_.id());
  glDispatchCompute((static_cast<GLuint>(host_.clusters.size()) + group_size - 1) / group_size, 1, 1);
  glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void renderer::begin_pass(const target& into) {
  constexpr float sky[4] = {0.46f, 0.63f, 0.86f, 0.0f}, farthest = 0.0f;
  constexpr GLuint none[4] = {};
  const GLuint framebuffer = into.framebuffer.id();
  glDepthMask(GL_TRUE);
  glColorMaski(1, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, sky);
  if (into.ids.id() != 0) glClearNamedFramebufferuiv(framebuffer, GL_COLOR, 1, none);
  glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &farthest);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, settings_.width, settings_.height);
}

void renderer::set_bin(const bin& b) {
  using sightcell::scene::alpha_mode;
  glUseProgram((b.alpha == alpha_mode::opaque ? opaque_ : b.alpha == alpha_mode::mask ? masked_ : blended_).id());
  glDepthMask(b.is_blended() ? GL_FALSE : GL_TRUE);
  const GLboolean has_id = b.is_blended() ? GL_FALSE : GL_TRUE;
  glColorMaski(1, has_id, has_id, has_id, has_id);
  (b.is_blended() ? glEnablei : glDisablei)(GL_BLEND, 0);
  (b.faces == facing::both ? glDisable : glEnable)(GL_CULL_FACE);
  glFrontFace(b.faces == facing::mirrored ? GL_CW : GL_CCW);
}

void renderer::bind_for_draws(const gl_buffer& commands, const gl_buffer& counts) {
  glBindVertexArray(vertex_array_);
  materials_.bind_storage(0);
  seen_.bind_storage(1);
  glBindTextureUnit(0, textures_.id());
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands.id());
  if (counts_) glBindBuffer(GL_PARAMETER_BUFFER_ARB, counts.id());
}

// region: half of the commands, of the first or the second pass.
void renderer::draw_bin(std::size_t b, std::uint32_t region) {
  const bin& own = host_.bins[b];
  set_bin(own);
  const void* const first = offset(command_bytes * (region * host_.clusters.size() + own.first_cluster));
  const auto most = static_cast<GLsizei>(own.cluster_count), stride = static_cast<GLsizei>(command_bytes);
  if (counts_) {  // for all bins: Mesa 22.3 on the CPU draws nothing if both calls follow each other
    const auto count = static_cast<GLintptr>(sizeof(std::uint32_t) * (region * host_.bins.size() + b));
    glMultiDrawElementsIndirectCountARB(GL_TRIANGLES, GL_UNSIGNED_INT, first, count, most, stride);
  } else {
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, first, most, stride);
  }
}

void renderer::draw_bins(std::uint32_t region, bool blended) {
  bind_for_draws(commands_, command_counts_);
  glProgramUniform1ui(blended_.id(), of_blended::marks, 0);
  for (std::size_t b = 0; b < host_.bins.size(); ++b) {
    if (host_.bins[b].is_blended() == blended) draw_bin(b, region);
  }
}

// What `last_frame` tests the next frame against.
void renderer::remember_depth() {
  last_depth_.build(shared_.depth);
  glCopyNamedBufferSubData(view_.id(), last_view_.id(), 0, 0, sizeof(camera_record));
}

void renderer::draw_everything() {
  seen_.clear();
  if (has_levels()) {
    begin_commands();
    cull(draw_mode::everything, stage::whole_cut, nullptr);
  }
  begin_pass(full_);
  bind_for_draws(has_levels() ? commands_ : all_commands_, has_levels() ? command_counts_ : all_counts_);
  glProgramUniform1ui(blended_.id(), of_blended::marks, 1);
  for (std::size_t b = 0; b < host_.bins.size(); ++b) draw_bin(b, 0);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);  // `seen`
}

std::uint32_t renderer::multi_draws(draw_mode mode) const {
  const auto all = static_cast<std::uint32_t>(host_.bins.size());
  if (mode != draw_mode::two_pass && mode != draw_mode::pvs_two_pass) return all;
  const auto blended = std::count_if(host_.bins.begin(), host_.bins.end(), [](const bin& b) { return b.is_blended(); });
  return 2 * all - static_cast<std::uint32_t>(blended);
}

}  // namespace gpu_driven
