#version 450 core
#include "shared/hemicube_layout.h"

// Polygons that are seen but never hide: every layer in front of the opaque depth counts, so they are marked here and
// never written to the id image. Without early tests hidden fragments would be marked too.
layout(early_fragment_tests) in;

layout(std430, binding = hemicube_buffer_counts) buffer counts_buffer { uint counts[]; };
layout(std430, binding = hemicube_buffer_found) buffer found_buffer {
  uint found_count;
  uint found[];
};

flat in uint polygon_id;

void main() {
  if (atomicAdd(counts[polygon_id], 1u) == 0u) found[atomicAdd(found_count, 1u)] = polygon_id;
}
