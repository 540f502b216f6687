#pragma once
// The hemicube source on EGL and OpenGL 4.5: R32UI ids and 32-bit float depth, three images in one atlas.
#include <memory>

#include "hemicube/gpu/gpu_culling.h"
#include "hemicube/hemicube_source.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// How pixels become polygon lists and importance sums: read back and walked on the CPU (quicker on a software
// rasteriser), or marked and reduced in compute shaders (quicker on a GPU). Both give the same hemicube_view::seen.
enum class gather { automatic, read_back, compute };

struct gpu_source_options {
  std::uint32_t resolution = 256;     // S, pixels along a face; even, 16..4096
  float far_plane = 1.0f;             // metres; depths are divided by it in the importance, background counts as 1
  gather how = gather::automatic;     // automatic: read_back on a software rasteriser, else compute
  culling hide = culling::automatic;  // which clusters are drawn; every way shows the same image
};

// Uploads the geometry. context and geometry must outlive the source, and context must be current at every call.
// Throws sightcell::error when the device cannot do it.
std::unique_ptr<hemicube_source> make_gpu_source(const picture::gl_context& context,
                                                 const scene::world_geometry& geometry,
                                                 const gpu_source_options& options);

}  // namespace sightcell::bake
