#include "depth_levels.h"

#include <algorithm>
#include <bit>

#include "gpu_driven_shaders/sources.h"

namespace gpu_driven {
namespace {

constexpr int levels_at_once = 5;                   // that depth_levels.comp makes
constexpr int group_side = 16;                      // texels of the first of them
constexpr GLint source_level = 0, level_count = 1;  // uniforms of it
constexpr float no_limit = 3.4e38f;

// A power of two, so that each texel of a level has four below it in all levels.
int padded(int pixels) {
  return static_cast<int>(std::bit_ceil(static_cast<unsigned>((pixels + 1) / 2)));
}

int groups(int texels) {
  return (texels + group_side - 1) / group_side;
}

}  // namespace

depth_levels::depth_levels(int width, int height)
    : width_(width),
      height_(height),
      count_(std::bit_width(static_cast<unsigned>(std::max(padded(width), padded(height))))),
      levels_(GL_R32F, padded(width), padded(height), count_),
      program_("depth_levels", {{GL_COMPUTE_SHADER, shaders::depth_levels_comp}}) {
  // Texels beside the picture, which no group writes.
  for (int level = 0; level < count_; ++level) glClearTexImage(levels_.id(), level, GL_RED, GL_FLOAT, &no_limit);
}

void depth_levels::build(const gl_texture& depth) const {
  glUseProgram(program_.id());
  int width = (width_ + 1) / 2, height = (height_ + 1) / 2;  // of the first level
  for (int first = 0; first < count_; first += levels_at_once) {
    const int made = std::min(levels_at_once, count_ - first);
    // The first level is made from the depths themselves, the next ones from the level before them.
    glBindTextureUnit(0, first == 0 ? depth.id() : levels_.id());
    glProgramUniform1i(program_.id(), source_level, std::max(first - 1, 0));
    glProgramUniform1i(program_.id(), level_count, made);
    for (int i = 0; i < levels_at_once; ++i) {
      const int level = first + std::min(i, made - 1);
      glBindImageTexture(static_cast<GLuint>(i), levels_.id(), level, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    }
    glDispatchCompute(static_cast<GLuint>(groups(width)), static_cast<GLuint>(groups(height)), 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    width = std::max((width + 31) >> levels_at_once, 1);
    height = std::max((height + 31) >> levels_at_once, 1);
  }
}

}  // namespace gpu_driven
