#pragma once
// The visibility volumes of a file, for `sightcell verify`. They are read from the file alone, and lines traverse them
// by other steps than those of volume_grid, so that an error of one of the two shows.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "sightcell/format/records.h"
#include "volumes/volume_trial.h"

namespace sightcell::bake {

class stored_volumes {
 public:
  // places: lattice positions on level 0, by volume number.
  stored_volumes(const format::lattice_shape& shape, std::span<const format::lattice_place> places);

  // Finds the volumes that a line passes before distance `to`, the nearest first. The traversal goes from border to
  // border; the point halfway between two borders decides which volume is between them.
  // to: in meters.
  // out: overwritten.
  void passed(const sight_line& line, double to, std::vector<passed_volume>& out) const;

 private:
  struct place_hash {
    std::size_t operator()(const glm::ivec3& place) const;
  };

  glm::dvec3 size_;       // of a volume in meters
  glm::dvec3 min_, max_;  // box around all volumes in meters
  std::unordered_map<glm::ivec3, std::uint32_t, place_hash> numbers_;
};

// The test for one cell set of a file.
class stored_trial final : public volume_trial {
 public:
  // volumes: must outlive the trial.
  // contains: returns whether a volume is in the set. Must outlive the trial.
  stored_trial(const stored_volumes& volumes, const std::function<bool(std::uint32_t)>& contains)
      : volumes_(volumes), contains_(contains) {}

  bool lacks(const sight_line& line, double to) const override;
  void lacking(const sight_line& line, double to, std::vector<passed_volume>& out) const override;

 private:
  const stored_volumes& volumes_;
  const std::function<bool(std::uint32_t)>& contains_;
};

}  // namespace sightcell::bake
