#pragma once
// The hemicube source of rays: Embree packets through the centers of all pixels. Slow, and independent of all that is
// drawn: the truth that the other sources are compared with.
#include <memory>

#include "sightcell/scene/scene.h"
#include "source/hemicube_source.h"

namespace sightcell::bake {

struct rays_source_options {
  std::uint32_t resolution = 256;  // S, pixels along a face; even, 16..4096
  float far_plane = 1.0f;          // metres; depths are divided by it in the importance, background counts as 1
};

// geometry must outlive the source, which may be called from several threads at a time; several poses of one call are
// traced in parallel on the caller's arena. Throws sightcell::error where resolution or far_plane are out of range.
std::unique_ptr<hemicube_source> make_rays_source(const scene::world_geometry& geometry,
                                                  const rays_source_options& options);

}  // namespace sightcell::bake
