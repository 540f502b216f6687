#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/alpha_test.glsl"

// MASK polygons are visible and occlude where their alpha reaches the cutoff.
flat in uint polygon_id;
layout(location = 0) out uint id;

void main() {
  if (!alpha_passes()) discard;
  id = polygon_id;
}
