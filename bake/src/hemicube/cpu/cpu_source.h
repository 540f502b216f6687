#pragma once
// Hemicube source with a rasterizer on the CPU: the default where there is no hardware GPU.
#include <memory>
#include <vector>

#include "hemicube/hemicube_source.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Instruction sets of the kernels. All kernels compute the same bits. portable has no SIMD and is slow.
enum class cpu_instructions { avx2, sse4, neon, portable };

// The instruction sets that this build contains and this processor has, fastest first. The last one is portable.
std::vector<cpu_instructions> available_instructions();

struct cpu_source_options {
  std::uint32_t resolution = 256;  // S, pixels along a face; even, 16..4096
  float far_plane = 1.0f;          // meters; depths are divided by it in the importance, background counts as 1
  cpu_instructions instructions = available_instructions().front();  // one of available_instructions()
  bool importance = true;    // false: hemicube_view::importance is 0
  bool when_needed = false;  // whether clusters are built by the first call, because there may be none
};

// Builds clusters of the geometry, which is not needed afterwards. With when_needed it must outlive the source.
// Several threads may call the source at a time; the poses of one call are drawn in parallel on the caller's TBB arena.
// The source keeps one set of image buffers for each call that runs at the same time. Throws sightcell::error where resolution or far_plane is out of range.
std::unique_ptr<hemicube_source> make_cpu_source(const scene::world_geometry& geometry,
                                                 const cpu_source_options& options);

}  // namespace sightcell::bake
