#pragma once
// The hemicube source of rays: Embree packets through the centers of all pixels. Slow, and independent of all that is
// drawn: the truth that the other sources are compared with.
//
// What a ray sees is what ray_scene::look sees, but for what hides nothing: it is seen up to rule 2's reach behind the
// front surface, so that decals on a wall are. Of exact duplicates (rule 2) the lowest source id is noted; which of
// other surfaces in exactly the same place, is Embree's choice, the same in every run.
#include <memory>

#include "hemicube/hemicube_source.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

struct rays_source_options {
  std::uint32_t resolution = 256;  // S, pixels along a face; even, 16..4096
  float far_plane = 1.0f;          // metres; depths are divided by it in the importance, background counts as 1
  // Packets of 16 where there is AVX-512, for benchmarks: quicker, and another tree, so that a few pixels at edges may
  // differ from those of other machines. For a source with a ray scene of its own.
  bool widest = false;
};

// geometry must outlive the source, which may be called from several threads at a time; several poses of one call are
// traced in parallel on the caller's arena. Throws sightcell::error where resolution or far_plane are out of range.
std::unique_ptr<hemicube_source> make_rays_source(const scene::world_geometry& geometry,
                                                  const rays_source_options& options);

// The same with the tree of a ray scene that there is already, which must outlive the source.
std::unique_ptr<hemicube_source> make_rays_source(const ray_scene& rays, const rays_source_options& options);

}  // namespace sightcell::bake
