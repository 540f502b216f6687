#pragma once
// Verified dilation by priority. A neighbor of a visible polygon is probably visible too, so rays are aimed at it
// from the viewpoint that showed the visible one best, in the order of the solid angle of the neighbors. Only
// polygons that a ray hits join.
#include <array>
#include <cstdint>
#include <numbers>
#include <vector>

#include "cell_set/cell_set.h"
#include "search/near_polygons.h"
#include "sightcell/base/random.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

inline constexpr double whole_sphere = 4.0 * std::numbers::pi;  // solid angle of all directions, sr

// The parameters of a refinement in one cell.
struct refinement_settings {
  std::uint64_t seed = 0, place = 0;
  float smallest_gap = 0.0f;  // meters; polygons visible only through narrower gaps do not join (visibility rule 3)
  purpose use = purpose::dilation;
  // Valid viewpoints of the cell where tries start after a first miss, in an order that does not depend on ids. May
  // grow between runs. Null: all tries start at witnesses. Must outlive the object, like the limit.
  const std::vector<glm::vec3>* viewpoints = nullptr;
  const time_limit* limit = nullptr;             // when it is reached, tries stay queued
  float largest_priority = largest_solid_angle;  // of a try, sr
  // Number of members of the set whose neighbors an earlier search tried, and the priority, in sr, down to which it
  // did; tries for them resume below it. 0: these members get no tries.
  std::size_t known = 0;
  double tried = 0.0;
};

// A try is a ray from the witness of a member toward a random point of a neighbor of that member. After a miss it
// starts at another viewpoint of the cell, because what the witness does not show is mostly visible from elsewhere.
// The priority of a try is the solid angle of the neighbor as seen from the member's witness, limited to
// largest_priority and divided by 1024 for each ray that missed. Where tries rarely hit, one that missed is dropped.
// Tries are queued in levels that differ by a factor of two. A level is processed in waves. All rays of a wave use one
// state of the set, with one ray per polygon, so that a polygon with several neighbors in the set is tried from
// different viewpoints. The result depends neither on threads nor on the order of ids.
class refinement {
 public:
  // References must outlive the object.
  refinement(const ray_scene& rays, const near_polygons& neighbors, const refinement_settings& how, cell_set& set);

  // Processes tries of this priority (sr) or more, to within a factor of two, including those of polygons that join,
  // until none is left or max_rays are cast. Returns the number of rays cast. Runs on the calling thread's TBB arena.
  std::uint64_t run(double priority, std::uint64_t max_rays);
  bool done() const;  // returns whether no try is queued
  // Returns whether fewer than 5 % of the first tries hit, once there are 2,000. So it is among leaves: what hemicubes
  // did not show there is visible through small gaps alone, so that tries find next to nothing.
  bool rarely_hits() const { return first_tries_ >= 2000 && 20 * first_hits_ < first_tries_; }

 private:
  static constexpr std::size_t level_count = 48;

  // A queued try.
  struct attempt {
    std::uint32_t target = 0, member = 0;
    float priority = 0.0f;
    std::uint32_t misses = 0;
  };

  // The ray of a try.
  struct aimed_try {
    sight_line line;
    float length = 0.0f;                // distance to the point aimed at, meters
    std::uint32_t which = 0, code = 0;  // index of the try, code of the direction
    std::uint64_t name = 0;             // identifies the pair by position
  };

  // Queues tries for the neighbors of members that joined since the last call.
  void take_members();
  bool leave_tried(attempt& one) const;
  glm::vec3 eye_of(const attempt& one, random_stream& random) const;
  void push(const attempt& one);
  std::vector<aimed_try> aim(const std::vector<attempt>& tries) const;
  std::uint64_t run_wave(std::vector<attempt>& wave);
  bool over() const { return how_.limit && how_.limit->reached(); }
  bool stopped() const { return how_.limit && how_.limit->stopped(); }

  const ray_scene& rays_;
  const near_polygons& neighbors_;
  const refinement_settings how_;
  cell_set& set_;
  std::size_t taken_;                               // members whose neighbors were queued
  std::uint64_t first_tries_ = 0, first_hits_ = 0;  // tries without a miss before, and those of them that hit
  std::array<std::vector<attempt>, level_count> levels_;
};

}  // namespace sightcell::bake
