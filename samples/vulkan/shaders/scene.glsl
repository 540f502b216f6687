// What all shaders of the sample read: draws and materials of the scene. gpu_records.h has the same structs.
#ifndef SCENE_GLSL
#define SCENE_GLSL

const uint no_bin = 0xFFFFFFFFu;

struct draw_record {
  vec4 row_x, row_y, row_z;  // to world space
  vec4 sphere;               // world space: center, radius
  uint first_index;          // of its primitive, in the index buffer in stored order
  int vertex_offset;
  uint bin;  // no_bin: not drawn
  uint material;
};

struct material_record {
  vec4 base_color;
  float alpha_cutoff;
  uint base_texture;    // layer of the texture array
  uint wrap_u, wrap_v;  // 0: repeat, 1: clamp, 2: mirror
};

layout(std430, set = 0, binding = 0) readonly buffer draw_block { draw_record draws[]; };
layout(std430, set = 0, binding = 1) readonly buffer material_block { material_record materials[]; };

#endif
