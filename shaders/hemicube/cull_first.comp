#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/cull.glsl"

// First pass: draws the clusters in the frustum that were visible in one of the last hemicubes.
void main() {
  uint cluster = gl_GlobalInvocationID.x, face = gl_WorkGroupID.y;
  if (cluster >= scene.cluster_count) return;
  write_draw(cluster, face, in_first_pass(cluster) && in_frustum(clusters[cluster], view.faces[face]));
}
