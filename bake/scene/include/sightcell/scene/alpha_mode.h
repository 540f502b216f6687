#pragma once
// How alpha decides where a polygon exists, in the terms of glTF.
#include <cstdint>

namespace sightcell::scene {

enum class alpha_mode : std::uint8_t {
  opaque,
  mask,  // exists where alpha reaches the cutoff, and occludes there
  blend  // visible everywhere, non-occluder
};

// What a texture shows outside 0 .. 1.
enum class wrap : std::uint8_t { repeat, clamp, mirror };

}  // namespace sightcell::scene
