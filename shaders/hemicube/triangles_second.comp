#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/lists.glsl"
#include "hemicube/cluster_group.glsl"
#include "hemicube/triangles.glsl"
#include "hemicube/occluded.glsl"

// The triangles of the second pass: those alone that the depths of the first pass do not occlude.
void main() {
  uint number = cluster_number();
  if (number >= all_clusters.w) return;
  uint list = list_of(number), command = command_of(number, list), local = gl_LocalInvocationIndex;
  bool keep = false;
  if (3u * local < packed_commands[command]) {
    hemicube_cull_face face = view.faces[list / hemicube_classes];
    triangle_place place;
    keep = !without_pixels(packed_commands[command + 2u] + 3u * local, face, (list & 1u) != 0u, place) &&
           !(place.on_screen && occluded(place.low, place.high, face, place.nearest, view.eye.w, 2));
  }
  record(number, keep);
}
