#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/cull_scene.glsl"
#include "hemicube/cull.glsl"

// First pass: draws the clusters in the frustum that were visible in one of the last hemicubes.
void main() {
  uint cluster = cluster_of_invocation(gl_WorkGroupID.x, gl_LocalInvocationIndex), face = gl_WorkGroupID.y;
  bool drawn = cluster != no_cluster && in_first_pass(cluster) && in_frustum(clusters[cluster], view.faces[face]);
  write_draw(cluster, face, drawn);
}
