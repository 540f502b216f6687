#pragma once
// Verified dilation ordered by what it is worth: what lies next to a seen polygon is likely seen too, so rays are aimed
// at it from where the seen one was seen best, those that would cover most of the picture first. Only what a ray truly
// hits joins.
#include <array>
#include <cstdint>
#include <numbers>
#include <vector>

#include "cell_set/cell_set.h"
#include "search/near_polygons.h"
#include "sightcell/base/random.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

inline constexpr double whole_sphere = 4.0 * std::numbers::pi;  // sr

struct refinement_settings {
  std::uint64_t seed = 0, place = 0;
  float smallest_gap = 0.0f;  // what is seen only through narrower cracks does not join (rule 3)
  purpose use = purpose::dilation;
  // Free places of the cell where tries begin that follow a miss, in an order that ids have no part in; may grow
  // between runs. Null: all tries begin at witnesses. As the next one it must outlive the object.
  const std::vector<glm::vec3>* places = nullptr;
  const time_limit* limit = nullptr;  // where it is reached, what waits goes on waiting
  // So many members were there before, and who found them had gone beside them, down to tries worth `tried` sr: those
  // go on below that. 0: nothing is left of them.
  std::size_t known = 0;
  double tried = 0.0;
};

// A *try* is a ray from the witness of a member toward a random point of a polygon beside it; after a miss from another
// place in the cell, because what the witness does not see is mostly seen from somewhere else. Its worth is the solid
// angle of that polygon from the member's witness, a quarter of it after each ray that missed. Tries wait in levels of
// worth, a factor of two each; a level is worked off in waves, each from one state of the set and with one ray per
// polygon, so that a polygon that several members are beside is looked at from different places. Neither threads nor
// the order of ids matter.
class refinement {
 public:
  // References must outlive the object.
  refinement(const ray_scene& rays, const near_polygons& neighbors, const refinement_settings& how, cell_set& set);

  // Works off tries worth `worth` sr or more (within a factor of two), those of what joins on the way too, until none
  // is left or max_rays are cast; returns how many were. Runs on the calling thread's TBB arena.
  std::uint64_t run(double priority, std::uint64_t max_rays);
  bool done() const;  // nothing waits

 private:
  static constexpr std::size_t level_count = 48;

  struct attempt {
    std::uint32_t target = 0, member = 0;
    float priority = 0.0f;
    std::uint32_t misses = 0;
  };

  struct aimed_try {
    sight_line line;
    float length = 0.0f;  // to the point aimed at
    std::uint32_t which = 0, code = 0;
    std::uint64_t name = 0;
  };

  void take_members();
  bool leave_tried(attempt& one) const;
  glm::vec3 eye_of(const attempt& one, random_stream& random) const;
  void push(const attempt& one);
  std::vector<aimed_try> aim(const std::vector<attempt>& tries) const;
  std::uint64_t run_wave(std::vector<attempt>& wave);
  bool over() const { return how_.limit && how_.limit->reached(); }

  const ray_scene& rays_;
  const near_polygons& neighbors_;
  const refinement_settings how_;
  cell_set& set_;
  std::size_t taken_;  // members that were looked beside of
  std::array<std::vector<attempt>, level_count> levels_;
};

}  // namespace sightcell::bake
