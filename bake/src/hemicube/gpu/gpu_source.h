#pragma once
// Hemicube source on EGL and OpenGL 4.5: R32UI ids and 32-bit float depth, three images in one atlas.
#include <memory>

#include "hemicube/gpu/gpu_culling.h"
#include "hemicube/gpu/gpu_timeline.h"
#include "hemicube/hemicube_source.h"
#include "sightcell/picture/gl_context.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Where the pixels are counted and the importance is summed: on the CPU after read-back (faster with a software
// rasterizer), or in compute shaders (faster on a GPU). Both give the same hemicube_view::seen.
enum class gather { automatic, read_back, compute };

struct gpu_source_options {
  std::uint32_t resolution = 256;     // S, pixels along a face; even, 16..4096
  float far_plane = 1.0f;             // meters; depths are divided by it in the importance, background counts as 1
  gather how = gather::automatic;     // automatic: read_back on a software rasterizer, else compute
  culling hide = culling::automatic;  // which clusters are drawn; does not change the image
  std::uint32_t most_triangles = 16'000'000;  // of a pass, for culling by occlusion: see make_occlusion_culling()
  gpu_timeline* timeline = nullptr;  // if not null, records the stages of each hemicube; must outlive the source
};

// Uploads the geometry. context and geometry must outlive the source, and context must be current at every call: so
// only one thread may call it. make_source_on_thread() makes it a source for several. Throws sightcell::error where the
// device lacks a feature.
std::unique_ptr<hemicube_source> make_gpu_source(const picture::gl_context& context,
                                                 const scene::world_geometry& geometry,
                                                 const gpu_source_options& options);

}  // namespace sightcell::bake
