#version 450
// One thread per cluster of the host: its bit in the row of sightcell_view_clusters, then the frustum.
#extension GL_GOOGLE_include_directive : require
#include "cull.glsl"

struct cluster_record {
  vec4 sphere;  // world space
  uint first_index, index_count;
  uint draw;
  uint unused;
};

layout(local_size_x = 64) in;
layout(std430, set = 1, binding = 0) readonly buffer cluster_block { cluster_record clusters[]; };
layout(std430, set = 1, binding = 1) readonly buffer bit_block { uint bits[]; };

void main() {
  uint c = gl_GlobalInvocationID.x;
  if (c >= count) return;
  bool in_set = (bits[c >> 5] >> (c & 31u) & 1u) != 0u;
  cluster_record cluster = clusters[c];
  draw_record own = draws[cluster.draw];
  draw_command command = draw_command(cluster.index_count, 1u, cluster.first_index, own.vertex_offset, cluster.draw);
  put(command, own.bin, c - bins[own.bin].first_slot, in_set && in_frustum(cluster.sphere));
}
