#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/alpha_test.glsl"
#include "hemicube/mark.glsl"

// Non-occluders with an alpha test: as see_through.frag, where their alpha reaches the cutoff.
layout(early_fragment_tests) in;

flat in uint polygon_id;

void main() {
  if (alpha_passes()) mark(polygon_id, ivec2(gl_FragCoord.xy), 1u);
}
