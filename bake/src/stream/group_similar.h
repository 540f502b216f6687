#pragma once
// Divides items into groups of limited size whose sketches are similar.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "stream/sketches.h"

namespace sightcell::bake {

struct grouped_item {
  const sketch* seen = nullptr;
  glm::vec3 place{0.0f};   // where sketches do not divide, near items stay together
  std::uint32_t size = 1;  // in the unit of the limit
  std::uint32_t number = 0;
};

// Divides items into groups whose sizes sum to at most `limit`; an item above the limit is a group of its own. Similar
// groups follow each other.
// items: changed. Returned groups are consecutive items.
// Cost: O(n log n).
std::vector<std::span<grouped_item>> group_similar(std::span<grouped_item> items, std::uint64_t limit);

}  // namespace sightcell::bake
