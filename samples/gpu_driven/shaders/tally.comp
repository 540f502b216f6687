#version 450 core
// Counts clusters and triangles of a mode: drawn, seen, missed, in the PVS.
#include "records.glsl"

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer cluster_block { cluster_record clusters[]; };
layout(std430, binding = 1) readonly buffer seen_block { uint seen[]; };
layout(std430, binding = 2) readonly buffer bit_block { uint bits[]; };
layout(std430, binding = 3) readonly buffer drawn_block { uint drawn[]; };
layout(std430, binding = 4) readonly buffer wrong_block { uint wrong_in[]; };
layout(std430, binding = 5) buffer tally_block { uint tally[]; };

layout(location = 0) uniform uint cluster_count;
layout(location = 1) uniform uint first;

// wrong pixels, ties, and these: drawn clusters, triangles of them, drawn ones in the PVS, seen ones, seen ones in the
// PVS, missed (seen and not drawn), those of the missed with a wrong pixel.
shared uint sums[7];

void main() {
  uint own = gl_LocalInvocationIndex;
  if (own < 7u) sums[own] = 0u;
  barrier();
  uint c = gl_GlobalInvocationID.x;
  if (c < cluster_count) {
    bool is_drawn = drawn[c] != 0u, is_seen = seen[c] != 0u, is_in_set = (bits[c >> 5] >> (c & 31u) & 1u) != 0u;
    if (is_drawn) {
      atomicAdd(sums[0], 1u);
      atomicAdd(sums[1], clusters[c].index_count / 3u);
      if (is_in_set) atomicAdd(sums[2], 1u);
    }
    if (is_seen) atomicAdd(sums[3], 1u);
    if (is_seen && is_in_set) atomicAdd(sums[4], 1u);
    if (is_seen && !is_drawn) {
      atomicAdd(sums[5], 1u);
      if (wrong_in[c] != 0u || clusters[c].is_blended != 0u) atomicAdd(sums[6], 1u);
    }
  }
  barrier();
  if (own < 7u && sums[own] != 0u) atomicAdd(tally[first + 2u + own], sums[own]);
}
