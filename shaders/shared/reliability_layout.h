// Constants, structs and bindings of the reliability map; read by GLSL and by C++ (bake/src/source).
#ifdef __cplusplus
#pragma once
#include "shared/glsl_types.h"
namespace sightcell::shaders {
#endif

const uint reliability_map_size = 256u;  // texels along a side
// A work group of reliability.comp takes a square of the map, one of lowest.comp the lowest texel of each square.
const uint reliability_group_side = 16u;
const uint reliability_groups = 256u;

const uint reliability_block = 4u;  // reliability_change

const uint reliability_buffer_samples = 0u;   // reliability_sample
const uint reliability_buffer_excluded = 1u;  // uvec4 each: first column and row, last column and row
const uint reliability_buffer_values = 2u;    // a float per texel, row by row
const uint reliability_buffer_lowest = 3u;    // reliability_texel per work group
const uint reliability_buffer_result = 4u;    // the lowest of all

struct reliability_sample {
  vec4 place;     // xy in face coordinates
  vec4 variance;  // sigma^2 toward right, up, left, down
};

struct reliability_change {
  vec4 aspect;        // xy: sides of the face divided by the longer one
  uint first_sample;  // those before it are in the map already; 0 makes the map anew
  uint sample_count;
  uint excluded_count;
  uint unused_word;
};

struct reliability_texel {
  float reliability;
  uint number;  // row by row
};

#ifdef __cplusplus
static_assert(reliability_map_size * reliability_map_size ==
              reliability_groups * reliability_group_side * reliability_group_side);
static_assert(sizeof(reliability_sample) == 32);
static_assert(sizeof(reliability_change) == 32);
static_assert(sizeof(reliability_texel) == 8);
}  // namespace sightcell::shaders
#endif
