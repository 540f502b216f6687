#version 450 core
#include "shared/hemicube_layout.h"
#include "hemicube/mark.glsl"

// Polygons that are seen but never hide: every layer in front of the opaque depth counts, so they are marked here and
// never written to the id image. Without early tests hidden fragments would be marked too.
layout(early_fragment_tests) in;

flat in uint polygon_id;

void main() { mark(polygon_id, ivec2(gl_FragCoord.xy)); }
