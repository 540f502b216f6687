#pragma once
// Where dilation looks: what shares a vertex with a polygon, and what lies on top of it.
#include <cstdint>

#include "search/vertex_neighbors.h"
#include "sightcell/bake/settings.h"
#include "trace/coincident.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

struct near_polygons {
  explicit near_polygons(const ray_scene& rays) : sharing(rays.geometry()), coinciding(rays) {}

  vertex_neighbors sharing;
  coincident_partners coinciding;

  // Calls visit(neighbor), some more than once, the polygon itself too; in a fixed order.
  template <typename Visit>
  void for_each(std::uint32_t polygon, Visit visit) const {
    sharing.for_each(polygon, visit);
    for (const std::uint32_t partner : coinciding.of(polygon)) visit(partner);
  }
};

// Does such a bake look for, or take, anything beside what it knows?
inline bool needs_neighbors(const settings& how) {
  return how.max_pixel_error > 0.0 || how.sampler == "guided" || how.safety_ring != safety_ring::none;
}

}  // namespace sightcell::bake
