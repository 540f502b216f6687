#pragma once
// Hierarchical depth (Greene et al. 1993): level k has the farthest depth of each block of 2^(k+1) x 2^(k+1) pixels.
#include "gl_objects.h"
#include "sightcell/picture/gl_program.h"

namespace gpu_driven {

class depth_levels {
 public:
  // width, height: pixels of the depth image.
  depth_levels(int width, int height);

  // Fills all levels. depth: a texture of the size, which was drawn before.
  void build(const gl_texture& depth) const;

  const gl_texture& texture() const { return levels_; }

 private:
  int width_, height_, count_;
  gl_texture levels_;
  sightcell::picture::gl_program program_;
};

}  // namespace gpu_driven
