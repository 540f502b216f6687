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

shared uint wrong_pixels, ties;

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
    } else if (any(greaterThan(abs(full.rgb - own.rgb), vec3(0.03)))) {
      atomicAdd(ties, 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex != 0u) return;
  if (wrong_pixels != 0u) atomicAdd(tally[first], wrong_pixels);
  if (ties != 0u) atomicAdd(tally[first + 1u], ties);
}
