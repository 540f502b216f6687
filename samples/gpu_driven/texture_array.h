#pragma once
// The base color textures of the scene, with mip levels, as the layers of one array: all draws of a bin share it.
// Images are resized to one size for that.
#include <cstdint>
#include <vector>

#include "gl_objects.h"
#include "sightcell/scene/scene.h"

namespace gpu_driven {

// images: host_scene::textures of s. One that cannot be decoded is white.
// Throws gpu-driven.limit if there are more than the device has layers.
gl_texture make_texture_array(const sightcell::scene::scene& s, const std::vector<std::uint32_t>& images);

}  // namespace gpu_driven
