#pragma once
// What a device can do at most: the floors that hemicubes on it stand on.
#include <cstdint>

#include "sightcell/picture/gl_context.h"

namespace sightcell::bench {

struct gpu_counters {
  double pixels_per_second = 0.0;            // R32UI and D32F written, in screen-filling triangles over 3 S x S
  double triangles_per_second = 0.0;         // of an indexed mesh, each of about two pixels of 3 S x S, all in front
  double hidden_triangles_per_second = 0.0;  // the same behind a near wall: what overdraw costs
  double atomics_per_second = 0.0;           // in compute, each on its own word of 64 MiB (--quick: 1 MiB)
  double atomics_on_one_word_per_second = 0.0;
};

// Each counter runs for about as many seconds, best of three. The context must be current.
gpu_counters count_gpu(const picture::gl_context& context, std::uint32_t resolution, double seconds);

}  // namespace sightcell::bench
