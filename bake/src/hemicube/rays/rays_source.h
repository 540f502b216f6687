#pragma once
// Hemicube source that traces Embree packets through the centers of all pixels. Slow. It is independent of
// all rasterizers and so the reference for them.
//
// A ray finds the same polygons as ray_scene::look. In addition, non-occluders up to a small distance behind the
// nearest occluder are visible, so that decals on a wall are (rule 2, docs/method/visibility-rules.md). Of exact
// duplicates the lowest source id is reported. Of other surfaces in exactly the same place Embree reports one, the same
// in every run.
#include <memory>

#include "hemicube/hemicube_source.h"
#include "sightcell/scene/scene.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

struct rays_source_options {
  std::uint32_t resolution = 256;  // S, pixels along a face; even, 16..4096
  float far_plane = 1.0f;          // meters; depths are divided by it in the importance, background counts as 1
  // Packets of 16 where the processor has AVX-512, for benchmarks. This is faster, but Embree then builds another tree,
  // so a few pixels at edges may differ between machines. Only for a source with a ray scene of its own.
  bool widest = false;
  bool importance = true;  // false: hemicube_view::importance is 0
};

// geometry must outlive the source. Several threads may call the source at a time; the poses of one call are traced in
// parallel on the caller's TBB arena. Throws sightcell::error where resolution or far_plane is out of range.
std::unique_ptr<hemicube_source> make_rays_source(const scene::world_geometry& geometry,
                                                  const rays_source_options& options);

// The same with the tree of an existing ray scene, which must outlive the source.
std::unique_ptr<hemicube_source> make_rays_source(const ray_scene& rays, const rays_source_options& options);

}  // namespace sightcell::bake
