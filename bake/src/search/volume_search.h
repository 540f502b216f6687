#pragma once
// Which volumes does a cell see? Every ray that the scene lets through from one of its places sees all volumes on its
// way, so rays toward what was seen, and then toward volumes beside those that are seen, tell.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cell_set/cell_set.h"
#include "sightcell/base/box.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"
#include "volumes/volume_grid.h"
#include "volumes/volume_trial.h"

namespace sightcell::bake {

struct volume_search_settings {
  std::uint64_t seed = 0, place = 0;
  float player_radius = 0.05f;
  float smallest_gap = 0.0f;          // what is seen only through narrower cracks is not seen (rule 3)
  const time_limit* limit = nullptr;  // null: none
};

// What a cell in work takes where there are so many volumes: with its set.
inline std::size_t volume_search_bytes(const volume_grid& grid) {
  return volume_set::bytes_for(grid.count()) + std::size_t{grid.count()} * (sizeof(std::uint32_t) + 1);
}

class volume_search {
 public:
  // The volumes that touch the grown box join the set at once: whoever is in them is where the eye may be. References
  // must outlive the object; the set's polygons are those that were found so far.
  volume_search(const ray_scene& rays, const volume_grid& grid, const box& grown, const volume_search_settings& how,
                cell_set& set);

  // Rays beside what is seen, as long as a try is worth so much, sr: the solid angle of the volume that it is aimed at,
  // divided by the tries, because of one that k rays missed about a part of 1 / (k + 2) may show (Laplace's rule of
  // succession). At first also a ray to each polygon of the set, and rays all around. Only what a ray passes joins.
  // Runs on the calling thread's TBB arena; the result does not depend on the number of threads.
  void look_for(double priority);
  // Others saw these.
  void add(std::span<const found_volume> found);
  // Sight rays and tested places.
  std::uint64_t spent() const { return spent_; }

 private:
  struct line_to_cast {
    sight_line line;
    std::uint32_t code = 0;                    // of its direction
    std::uint32_t target = volume_grid::none;  // not cast where the set has it by now
  };

  bool over() const { return how_.limit && how_.limit->reached(); }
  void join(std::uint32_t volume, const glm::vec3& eye);
  void cast(std::vector<line_to_cast> lines);
  void cast_wave(std::span<const line_to_cast> lines);
  std::vector<line_to_cast> first_lines() const;
  std::vector<line_to_cast> next_lines(double priority);
  double priority_of(std::uint32_t volume) const;
  const glm::vec3& eye_beside(std::uint32_t volume) const;

  const ray_scene& rays_;
  const volume_grid& grid_;
  const box grown_;
  const volume_search_settings how_;
  cell_set& set_;
  std::vector<glm::vec3> places_;          // where rays begin
  std::vector<glm::vec3> eyes_;            // that saw a volume
  std::vector<std::uint32_t> eye_of_;      // by volume, into eyes_; none: it is not a member
  std::vector<std::uint8_t> tries_;        // by volume: rays that were aimed at it
  std::vector<std::uint32_t> candidates_;  // beside a member
  bool began_ = false;
  std::uint64_t spent_ = 0;
};

}  // namespace sightcell::bake
