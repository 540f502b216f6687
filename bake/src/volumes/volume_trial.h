#pragma once
// What one ray is wrong about where a file has volumes: it passes one that the set of its cell lacks.
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
  float distance = 0.0f;  // at which the line enters it
};

// With an eye that sees it.
struct found_volume {
  std::uint32_t volume = 0;
  glm::vec3 eye{0.0f};
  bool operator<(const found_volume& other) const {
    return std::tie(volume, eye.x, eye.y, eye.z) < std::tie(other.volume, other.eye.x, other.eye.y, other.eye.z);
  }
};

// One set's. Asked from many threads.
class volume_trial {
 public:
  volume_trial() = default;
  volume_trial(const volume_trial&) = delete;
  volume_trial& operator=(const volume_trial&) = delete;
  virtual ~volume_trial() = default;

  // Does the line pass, before distance `to`, a volume that the set lacks?
  virtual bool lacks(const sight_line& line, double to) const = 0;
  // All of these, the nearest first. out is overwritten.
  virtual void lacking(const sight_line& line, double to, std::vector<passed_volume>& out) const = 0;
};

// Of a cell in work.
class grid_trial final : public volume_trial {
 public:
  // Both must outlive the trial.
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

// How far a ray goes through free space: what begins where it ends, as volumes do under a floor that lies on the
// lattice, is behind what it met, whatever rounding says.
inline double free_length(const sight& seen) {
  if (seen.front == no_polygon) return std::numeric_limits<double>::infinity();
  return static_cast<double>(seen.distance - coincidence_reach(seen.distance));
}

// Rule 3 of seeing: what lies behind a crack that lets nothing through is not seen. passed: the nearest first. What is
// hidden at one distance is hidden at every larger one, so a few questions tell.
inline void drop_behind_gaps(const ray_scene& rays, const sight_line& line, float smallest_gap,
                             std::vector<passed_volume>& passed) {
  const auto is_seen = [&](const passed_volume& p) {
    return !rays.through_gap(line.eye, line.direction, p.distance, smallest_gap);
  };
  if (passed.empty() || is_seen(passed.back())) return;
  passed.erase(std::partition_point(passed.begin(), passed.end(), is_seen), passed.end());
}

}  // namespace sightcell::bake
