#include "comparison.h"

#include "gpu_driven_shaders/sources.h"

namespace gpu_driven {
namespace {

constexpr int tile = 8;  // pixels: the groups of seen.comp and compare.comp
constexpr std::uint32_t tally_group = 64;
constexpr GLint near_uniform = 0, compare_first = 1, count_uniform = 0, tally_first = 1;

void dispatch_pixels(const renderer::settings& size) {
  glDispatchCompute(static_cast<GLuint>((size.width + tile - 1) / tile),
                    static_cast<GLuint>((size.height + tile - 1) / tile), 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

}  // namespace

comparison::comparison(const host_scene& host, const renderer& draws)
    : draws_(draws),
      cluster_count_(static_cast<std::uint32_t>(host.clusters.size())),
      tallies_(mode_count * sizeof(tally), nullptr),
      wrong_in_(host.clusters.size() * sizeof(std::uint32_t), nullptr),
      seen_("seen", {{GL_COMPUTE_SHADER, shaders::seen_comp}}),
      compare_("compare", {{GL_COMPUTE_SHADER, shaders::compare_comp}}),
      tally_("tally", {{GL_COMPUTE_SHADER, shaders::tally_comp}}) {
  glProgramUniform1f(compare_.id(), near_uniform, near_plane);
  glProgramUniform1ui(tally_.id(), count_uniform, cluster_count_);
}

void comparison::begin_frame() const {
  tallies_.clear();
  glUseProgram(seen_.id());
  glBindTextureUnit(2, draws_.picture(draw_mode::everything).ids.id());
  draws_.seen().bind_storage(1);
  dispatch_pixels(draws_.size());
}

void comparison::add(draw_mode mode, const gl_buffer& bits) const {
  const target &full = draws_.picture(draw_mode::everything), &own = draws_.picture(mode);
  const auto first = static_cast<GLuint>(static_cast<std::size_t>(mode) * sizeof(tally) / sizeof(std::uint32_t));
  wrong_in_.clear();
  glBindTextureUnit(0, full.depth.id());
  glBindTextureUnit(1, full.color.id());
  glBindTextureUnit(2, full.ids.id());
  glBindTextureUnit(3, own.depth.id());
  glBindTextureUnit(4, own.color.id());
  draws_.drawn(mode).bind_storage(3);
  wrong_in_.bind_storage(4);
  tallies_.bind_storage(5);
  glProgramUniform1ui(compare_.id(), compare_first, first);
  glUseProgram(compare_.id());
  dispatch_pixels(draws_.size());

  draws_.clusters().bind_storage(0);
  draws_.seen().bind_storage(1);
  bits.bind_storage(2);
  glProgramUniform1ui(tally_.id(), tally_first, first);
  glUseProgram(tally_.id());
  glDispatchCompute((cluster_count_ + tally_group - 1) / tally_group, 1, 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

std::array<tally, mode_count> comparison::read() const {
  std::array<tally, mode_count> out;
  glGetNamedBufferSubData(tallies_.id(), 0, sizeof out, out.data());
  return out;
}

}  // namespace gpu_driven
