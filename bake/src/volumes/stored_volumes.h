#pragma once
// The volumes of a file, for who checks them: told from the file alone, and walked through by other steps than those of
// volume_grid, so that neither can hide an error of the other.
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
  // places: of level 0, by number.
  stored_volumes(const format::lattice_shape& shape, std::span<const format::lattice_place> places);

  // All that a line passes before distance `to`, the nearest first; out is overwritten. From border to border, and
  // where the middle between two of them lies tells which place that was.
  void passed(const sight_line& line, double to, std::vector<passed_volume>& out) const;

 private:
  struct place_hash {
    std::size_t operator()(const glm::ivec3& place) const;
  };

  glm::dvec3 size_;       // of a place
  glm::dvec3 min_, max_;  // of all, metres
  std::unordered_map<glm::ivec3, std::uint32_t, place_hash> numbers_;
};

// Of one cell's set in a file.
class stored_trial final : public volume_trial {
 public:
  // contains: is a volume in the set? Both must outlive the trial.
  stored_trial(const stored_volumes& volumes, const std::function<bool(std::uint32_t)>& contains)
      : volumes_(volumes), contains_(contains) {}

  bool lacks(const sight_line& line, double to) const override;
  void lacking(const sight_line& line, double to, std::vector<passed_volume>& out) const override;

 private:
  const stored_volumes& volumes_;
  const std::function<bool(std::uint32_t)>& contains_;
};

}  // namespace sightcell::bake
