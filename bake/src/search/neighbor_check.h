#pragma once
// What a neighboring cell sees is likely seen from this one too: a few rays for each polygon tell. Only what a ray
// truly hits joins.
#include <cstdint>
#include <span>

#include "bound/verification_rays.h"
#include "cell_set/cell_record.h"
#include "cell_set/cell_set.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

struct neighbor_check_settings {
  std::uint64_t seed = 0, place = 0;
  purpose use = purpose::neighbor_check;  // names the random numbers
  visibility_rules rules;
};

// Takes out of a neighbor's record what own has: it is not tried, and where many are read it is most of their memory.
// own: ascending.
void drop_known(std::span<const std::uint32_t> own, cell_record& neighbor);

// neighbors: records with witnesses, of one moment, the nearest first. What they have and set has not is tried from
// free places of the grown box: from the eyes of this set next to the neighbor's line of sight, from where that line
// enters the box, and from any eyes. set must have been loaded: its eyes() are tried. All is tried from one state of
// the set, finds join at the end. Returns the rays cast. Runs on the calling thread's TBB arena; does not depend on the
// number of threads.
std::uint64_t neighbor_check(const ray_scene& rays, const box& grown, const neighbor_check_settings& how,
                             std::span<const cell_record> neighbors, cell_set& set);

}  // namespace sightcell::bake
