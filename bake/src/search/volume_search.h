#pragma once
// Searches for the visibility volumes that are visible from a cell. A ray from a valid viewpoint sees every volume on
// its way to the first occluder. Rays are cast toward the polygons of the set, then toward neighbors of visible
// volumes.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cell_set/cell_set.h"
#include "sightcell/base/box.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"
#include "volumes/volume_grid.h"
#include "volumes/volume_trial.h"

namespace sightcell::bake {

// The parameters of a search for volumes in one cell.
struct volume_search_settings {
  std::uint64_t seed = 0, place = 0;
  float player_radius = 0.05f;  // meters
  float smallest_gap = 0.0f;  // meters; volumes visible only through narrower gaps are not visible (visibility rule 3)
  const time_limit* limit = nullptr;  // null: no limit
};

// Returns the bytes that the search and the volume set of one cell need.
inline std::size_t volume_search_bytes(const volume_grid& grid) {
  return volume_set::bytes_for(grid.count()) + std::size_t{grid.count()} * (sizeof(std::uint32_t) + 1);
}

// The search for volumes in one cell. Its state lasts over several calls.
class volume_search {
 public:
  // Adds the volumes that touch the grown box of the cell to the set, since the camera can be in them.
  // where: the region of viewpoints of the grown box.
  // set: its polygons are those found so far.
  // References must outlive the object.
  volume_search(const ray_scene& rays, const volume_grid& grid, const viewpoint_region& where,
                const volume_search_settings& how, cell_set& set);

  // Casts rays toward neighbors of visible volumes while a try has this priority (sr) or more. The priority is the
  // solid angle of the volume divided by one more than the number of tries, after Laplace's rule of succession: if k
  // rays missed a volume, about 1 / (k + 2) of it may be visible. The first call also casts a ray toward each polygon
  // of the set, and rays in all directions. Only volumes that a ray passes join. Runs on the calling thread's TBB
  // arena; the result does not depend on the number of threads.
  void look_for(double priority);
  // Adds volumes that other code found.
  void add(std::span<const found_volume> found);
  // Returns the number of rays cast and viewpoints tested.
  std::uint64_t spent() const { return spent_; }

 private:
  struct line_to_cast {
    sight_line line;
    std::uint32_t code = 0;                    // code of the direction
    std::uint32_t target = volume_grid::none;  // volume aimed at; the line is skipped if the set contains it by then
  };

  bool over() const { return how_.limit && how_.limit->reached(); }
  // Adds a volume and queues its neighbors.
  void join(std::uint32_t volume, const glm::vec3& eye);
  void cast(std::vector<line_to_cast> lines);
  void cast_wave(std::span<const line_to_cast> lines);
  std::vector<line_to_cast> first_lines() const;
  std::vector<line_to_cast> next_lines(double priority);
  double priority_of(std::uint32_t volume) const;
  const glm::vec3& eye_of_neighbor(std::uint32_t volume) const;

  const ray_scene& rays_;
  const volume_grid& grid_;
  const box grown_;
  const volume_search_settings how_;
  cell_set& set_;
  std::vector<glm::vec3> viewpoints_;      // origins of rays
  std::vector<glm::vec3> eyes_;            // that found a volume
  std::vector<std::uint32_t> eye_of_;      // per volume: index into eyes_; none: not a member
  std::vector<std::uint8_t> tries_;        // per volume: number of rays aimed at it
  std::vector<std::uint32_t> candidates_;  // neighbors of members
  bool began_ = false;
  std::uint64_t spent_ = 0;
};

}  // namespace sightcell::bake
