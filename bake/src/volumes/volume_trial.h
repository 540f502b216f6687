#pragma once
// Tests a verification ray against the volumes of a cell set: it is a miss if it passes a volume that the set lacks.
#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <tuple>
#include <vector>

#include "trace/ray_scene.h"
#include "volumes/volume_grid.h"
#include "volumes/volume_set.h"

namespace sightcell::bake {

struct passed_volume {
  std::uint32_t volume = 0;
  float distance = 0.0f;  // meters to where the line enters it
};

// A visible volume and a viewpoint from which it is visible.
struct found_volume {
  std::uint32_t volume = 0;
  glm::vec3 eye{0.0f};
  bool operator<(const found_volume& other) const {
    return std::tie(volume, eye.x, eye.y, eye.z) < std::tie(other.volume, other.eye.x, other.eye.y, other.eye.z);
  }
};

// The test for one cell set. May be called from several threads.
class volume_trial {
 public:
  volume_trial() = default;
  volume_trial(const volume_trial&) = delete;
  volume_trial& operator=(const volume_trial&) = delete;
  virtual ~volume_trial() = default;

  // Returns whether the line passes, before distance `to`, a volume that the set lacks.
  virtual bool lacks(const sight_line& line, double to) const = 0;
  // Finds all of these volumes, the nearest first. out is overwritten.
  virtual void lacking(const sight_line& line, double to, std::vector<passed_volume>& out) const = 0;
};

// The test for a cell that is being baked.
class grid_trial final : public volume_trial {
 public:
  // grid, set: must outlive the trial.
  grid_trial(const volume_grid& grid, const volume_set& set) : grid_(grid), set_(set) {}

  bool lacks(const sight_line& line, double to) const override {
    bool found = false;
    grid_.for_each_passed(line, to, [&](std::uint32_t volume, double) {
      found = !set_.contains(volume);
      return !found;
    });
    return found;
  }
  void lacking(const sight_line& line, double to, std::vector<passed_volume>& out) const override {
    out.clear();
    grid_.for_each_passed(line, to, [&](std::uint32_t volume, double distance) {
      if (!set_.contains(volume)) out.push_back({volume, static_cast<float>(distance)});
      return true;
    });
  }

 private:
  const volume_grid& grid_;
  const volume_set& set_;
};

// Returns the distance up to which a ray passes volumes, in meters: a little before the surface that it hits. A volume
// that begins at this surface, such as one below a floor in a lattice plane, is behind the surface whatever the
// rounding.
inline double free_length(const sight& seen) {
  if (seen.front == no_polygon) return std::numeric_limits<double>::infinity();
  return static_cast<double>(seen.distance - coincidence_reach(seen.distance));
}

// Removes the volumes behind a gap that is too narrow to count (light-leak tolerance, rule 3). A volume behind the gap
// is followed only by such volumes, so a binary search needs few tests.
// passed: the nearest first.
inline void drop_behind_gaps(const ray_scene& rays, const sight_line& line, float smallest_gap,
                             std::vector<passed_volume>& passed) {
  const auto is_seen = [&](const passed_volume& p) {
    return !rays.through_gap(line.eye, line.direction, p.distance, smallest_gap);
  };
  if (passed.empty() || is_seen(passed.back())) return;
  passed.erase(std::partition_point(passed.begin(), passed.end(), is_seen), passed.end());
}

}  // namespace sightcell::bake
