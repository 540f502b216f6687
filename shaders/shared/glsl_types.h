#pragma once
// Types of GLSL for C++ code that includes the shared headers.
#include <cstdint>

namespace sightcell::shaders {

using uint = std::uint32_t;

struct vec4 {
  float x, y, z, w;
};

struct uvec4 {
  uint x, y, z, w;
};

}  // namespace sightcell::shaders
