#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/lists.glsl"
#include "hemicube/cluster_group.glsl"
#include "hemicube/triangles.glsl"

// The triangles of the first pass.
void main() {
  uint number = cluster_number();
  if (number >= all_clusters.w) return;
  uint list = list_of(number), command = command_of(number, list), local = gl_LocalInvocationIndex;
  bool keep = false;
  if (3u * local < packed_commands[command]) {
    triangle_place place;
    keep = !without_pixels(packed_commands[command + 2u] + 3u * local, view.faces[list / hemicube_classes],
                           (list & 1u) != 0u, place);
  }
  record(number, keep);
}
