#pragma once
// Where a set is looked at, and what its pictures are like.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "bench/samplers/truth.h"
#include "sightcell/picture/picture.h"

namespace sightcell::bench {

struct worst_view {
  glm::vec3 eye{0.0f}, forward{0.0f, 0.0f, -1.0f};
  double missed_share = 0.0;  // of the rays from there
};

// Of the places from where truth has rays that the set misses, the one with the most, looking toward most of them. A
// set that misses nothing is looked at from where truth saw something, with a share of 0.
worst_view find_worst_view(const cell_truth& truth, const std::vector<std::uint32_t>& set);

// Every red pixel with its neighbors up to so many pixels away: single ones can be seen then.
picture::image_rgba grow_red(const picture::image_rgba& marked, std::uint32_t by);

}  // namespace sightcell::bench
