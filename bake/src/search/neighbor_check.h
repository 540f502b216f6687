#pragma once
// Tests the polygons in the sets of adjacent cells, which are probably visible from this cell too, with a few rays
// each. Only polygons that a ray hits join.
#include <cstdint>
#include <span>

#include "bound/verification_rays.h"
#include "cell_set/cell_record.h"
#include "cell_set/cell_set.h"
#include "search/refinement.h"
#include "sightcell/base/box.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// The parameters of a neighbor check in one cell.
struct neighbor_check_settings {
  std::uint64_t seed = 0, place = 0;
  purpose use = purpose::neighbor_check;  // key of the random numbers
  visibility_rules rules;
  // Solid angle in steradians. A polygon k times as large gets at most k rays from random eyes.
  double least_solid_angle = 0.0;
  const time_limit* limit = nullptr;  // polygons that are left when it is reached are not tested; null: no limit
};

// Returns the least solid angle with which a ray from a random eye is worth its cost, for a target of the miss
// probability. A polygon that six chosen rays did not see is seen by one random ray in 500 at first and by one in 2,000
// after the sixth (of 17 million in intel_castle and temple).
constexpr double least_solid_angle(double max_pixel_error) noexcept {
  constexpr double share_of_target = 1e-2;
  return share_of_target * max_pixel_error * whole_sphere;
}

// Removes from a neighbor's record the polygons that the cell has. They need no test, and they are most of the memory
// when many records are loaded.
// own: source ids of the cell, ascending.
void drop_known(std::span<const std::uint32_t> own, cell_record& neighbor);
// Removes from a bounded record the polygons that its cell had when it was sampled. A neighbor in the same block has
// tested them before its own bound.
void keep_late(cell_record& neighbor);

// Tests every polygon that a neighbor has and the set lacks, from valid viewpoints of the grown box: from eyes of the
// set close to the neighbor's sight line, from the point where that line enters the box, and large ones from random
// eyes of the set. All tests use the same state of the set, and finds join at the end. Returns the number of rays cast.
// neighbors: records with witnesses, all of one stage, nearest first.
// set: must have been loaded from a record, since its eyes() are used.
// Runs on the calling thread's TBB arena; the result does not depend on the number of threads.
std::uint64_t neighbor_check(const ray_scene& rays, const box& grown, const neighbor_check_settings& how,
                             std::span<const cell_record> neighbors, cell_set& set);

}  // namespace sightcell::bake
