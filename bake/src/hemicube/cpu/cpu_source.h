#pragma once
// The hemicube source of our own rasteriser: the default where there is no hardware GPU.
#include <memory>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// All give the same bits; portable is slow.
enum class cpu_instructions { avx2, sse4, neon, portable };

// The instruction sets that this build and this processor have, fastest first. portable is always the last.
std::vector<cpu_instructions> available_instructions();

struct cpu_source_options {
  std::uint32_t resolution = 256;  // S, pixels along a face; even, 16..4096
  float far_plane = 1.0f;          // metres; depths are divided by it in the importance, background counts as 1
  cpu_instructions instructions = available_instructions().front();  // one of available_instructions()
};

// Builds clusters of the geometry, which may go away afterwards. The source may be called from several threads at a
// time; several poses of one call are drawn in parallel on the caller's arena. As many places to draw in come to be as
// calls run at once. Throws sightcell::error where resolution or far_plane are out of range.
std::unique_ptr<hemicube_source> make_cpu_source(const scene::world_geometry& geometry,
                                                 const cpu_source_options& options);

}  // namespace sightcell::bake
