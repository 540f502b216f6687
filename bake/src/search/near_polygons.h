#pragma once
// The neighbors of a polygon for dilation: polygons that share a vertex with it or coincide with it.
#include <tbb/parallel_invoke.h>

#include <cstdint>

#include "search/vertex_neighbors.h"
#include "sightcell/bake/settings.h"
#include "trace/coincident.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// The neighbors of all polygons of a scene.
struct near_polygons {
  // before: as for coincident_partners.
  // Threads: runs in the TBB arena of the calling thread.
  explicit near_polygons(const ray_scene& rays, const partners_before* before = nullptr) {
    tbb::parallel_invoke([&] { sharing = vertex_neighbors(rays.geometry()); },
                         [&] { coinciding = coincident_partners(rays, before); });
  }

  vertex_neighbors sharing;
  coincident_partners coinciding;

  // Calls visit(neighbor) in a fixed order, for some neighbors more than once, and for the polygon itself.
  template <typename Visit>
  void for_each(std::uint32_t polygon, Visit visit) const {
    sharing.for_each(polygon, visit);
    for (const std::uint32_t partner : coinciding.of(polygon)) visit(partner);
  }
};

// Returns whether a bake with these settings uses dilation of any kind.
inline bool needs_neighbors(const settings& how) {
  return how.max_pixel_error > 0.0 || how.sampler == "guided" || how.safety_ring != safety_ring::none;
}

}  // namespace sightcell::bake
