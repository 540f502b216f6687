#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/mark.glsl"

// Non-occluders are visible at every layer in front of the opaque depth, so they are counted here and never written to
// the id image. Early tests are required: without them occluded fragments would be counted too.
layout(early_fragment_tests) in;

flat in uint polygon_id;

void main() { mark(polygon_id, ivec2(gl_FragCoord.xy), 1u); }
