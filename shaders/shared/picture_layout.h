// Structs and bindings of the picture shaders. Read by GLSL and by C++ (bake/picture/src).
#ifdef __cplusplus
#pragma once
#include "shared/glsl_types.h"
namespace sightcell::shaders {
#endif

const uint picture_attribute_position = 0u;
const uint picture_attribute_uv = 1u;
const uint picture_attribute_color = 2u;

const uint picture_block_view = 0u;
const uint picture_block_material = 1u;
const uint picture_texture_base_color = 0u;

// Clip coordinates are dot products with (position - eye). Depth is reversed and has no far plane.
struct picture_view {
  vec4 eye;     // xyz; w: distance of the near plane in meters
  vec4 clip_x;  // xyz
  vec4 clip_y;  // xyz
  vec4 clip_w;  // xyz; the direction the camera looks along
  vec4 sky;     // rgb, linear; w: haze per meter
};

struct picture_material {
  vec4 base_color;     // linear, multiplied with the texture
  float alpha_cutoff;  // fragments below it are discarded; 0 keeps all
  float alpha_opaque;  // 1: alpha is written as 1
  float unused_x, unused_y;
};

#ifdef __cplusplus
static_assert(sizeof(picture_view) == 80);
static_assert(sizeof(picture_material) == 32);
}  // namespace sightcell::shaders
#endif
