#version 450 core
// Compares a picture with that of everything. A pixel is wrong if it shows another place, or other blended polygons.
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D full_depths;
layout(binding = 1) uniform sampler2D full_colors;
layout(binding = 2) uniform usampler2D ids;
layout(binding = 3) uniform sampler2D depths;
layout(binding = 4) uniform sampler2D colors;
layout(std430, binding = 3) readonly buffer drawn_block { uint drawn[]; };
layout(std430, binding = 4) writeonly buffer wrong_block { uint wrong_in[]; };  // by cluster
layout(std430, binding = 5) buffer tally_block { uint tally[]; };

layout(location = 0) uniform float near;
layout(location = 1) uniform uint first;  // of this mode, in `tally`

const float another_color = 0.03;  // of a component, linear

shared uint wrong_pixels, ties, differing, difference;

// The bake calls surfaces coincident that are no farther apart than this.
bool is_same_place(float a, float b) {
  if (a == b) return true;
  if (a == 0.0 || b == 0.0) return false;
  float away = near / a;
  return abs(away - near / b) <= max(2e-4, 2e-5 * away);
}

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    wrong_pixels = 0u;
    ties = 0u;
    differing = 0u;
    difference = 0u;
  }
  barrier();
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (all(lessThan(at, textureSize(ids, 0)))) {
    vec4 full = texelFetch(full_colors, at, 0), own = texelFetch(colors, at, 0);
    bool wrong = !is_same_place(texelFetch(full_depths, at, 0).x, texelFetch(depths, at, 0).x) ||
                 abs(full.a - own.a) > 1.5 / 255.0;  // the alphas of blended polygons are each rounded to a level
    if (wrong) {
      uint id = texelFetch(ids, at, 0).x;
      if (id != 0u && drawn[id - 1u] == 0u) wrong_in[id - 1u] = 1u;
      atomicAdd(wrong_pixels, 1u);
    }
    vec3 away = abs(full.rgb - own.rgb);
    if (any(greaterThan(away, vec3(another_color)))) {
      if (!wrong) atomicAdd(ties, 1u);
      atomicAdd(differing, 1u);
    }
    uint levels = uint(255.0 * (away.r + away.g + away.b) + 0.5);
    if (levels != 0u) atomicAdd(difference, levels);
  }
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  if (wrong_pixels != 0u) atomicAdd(tally[first], wrong_pixels);
  if (ties != 0u) atomicAdd(tally[first + 1u], ties);
  if (differing != 0u) atomicAdd(tally[first + 9u], differing);
  if (difference != 0u) atomicAdd(tally[first + 10u], difference);
}
