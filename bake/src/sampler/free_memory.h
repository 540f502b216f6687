#pragma once
// Remembers where in the cells viewpoints were valid, so that fewer are tested inside walls. A test costs 64 rays.
#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>
#include "sightcell/base/box.h"

namespace sightcell::bake {

// Divides each cell into 8 x 4 x 8 parts and counts invalid viewpoints per part.
class free_memory {
 public:
  explicit free_memory(std::size_t cells) : invalid_in_a_row_(cells * parts_of_cell) {}

  // Returns the part of the cell's box that contains the point.
  static std::uint32_t part_of(const box& cell, const glm::vec3& place) {
    const glm::vec3 share = (place - cell.min) / (cell.max - cell.min);
    const auto along = [](float s, std::uint32_t n) {
      return static_cast<std::uint32_t>(std::clamp(s, 0.0f, 0.999f) * static_cast<float>(n));
    };
    return (along(share.z, wide) * high + along(share.y, high)) * wide + along(share.x, wide);
  }
  // Returns whether the last few viewpoints tested in this part were all invalid.
  bool is_barren(std::uint32_t cell, std::uint32_t part) const {
    return invalid_in_a_row_[number_of(cell, part)] >= barren_after;
  }
  // Records the result of a test.
  void note(std::uint32_t cell, std::uint32_t part, bool free) {
    std::uint8_t& invalid = invalid_in_a_row_[number_of(cell, part)];
    invalid = free ? std::uint8_t{0} : static_cast<std::uint8_t>(std::min(invalid + 1, int{barren_after}));
  }

 private:
  static constexpr std::uint32_t wide = 8, high = 4, parts_of_cell = wide * wide * high;
  static constexpr std::uint8_t barren_after = 3;
  static std::size_t number_of(std::uint32_t cell, std::uint32_t part) {
    return cell * std::size_t{parts_of_cell} + part;
  }

  std::vector<std::uint8_t> invalid_in_a_row_;  // per part of each cell: number of consecutive invalid viewpoints
};

}  // namespace sightcell::bake
