#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/lists.glsl"

// Where there was no room for the triangles of a list, its clusters are drawn with all triangles instead.
layout(local_size_x = hemicube_faces * hemicube_classes) in;

void main() {
  if (lists[gl_LocalInvocationIndex].whole_clusters != 0u) lists[gl_LocalInvocationIndex].index_count = 0u;
}
