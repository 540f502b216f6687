#pragma once
// Verified dilation: what lies next to a seen polygon, or in the same place, is likely seen too, so rays are aimed at
// it from where the seen one was seen best. Only what a ray truly hits joins.
#include <cstddef>
#include <cstdint>

#include "cell_set.h"
#include "finish/near_polygons.h"
#include "random.h"
#include "rays/ray_scene.h"

namespace sightcell::bake {

struct dilation_settings {
  std::uint64_t seed = 0, place = 0;
  float smallest_gap = 0.0f;  // what is seen only through narrower cracks does not join (rule 3)
  std::uint64_t max_rays = 0;
  purpose use = purpose::dilation;  // names the random numbers
};

// Expands the members from index first (in joining order) on, and in turn whatever joins, until nothing does or
// max_rays are spent. round: names the random numbers; raised by every wave. Returns the rays cast. Runs on the calling
// thread's TBB arena; does not depend on the number of threads.
std::uint64_t dilate(const ray_scene& rays, const near_polygons& neighbors, const dilation_settings& how,
                     std::size_t first, std::uint64_t& round, cell_set& set);

}  // namespace sightcell::bake
