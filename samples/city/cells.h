#pragma once
// View cells at street level: places where someone could walk, on crossings, in lanes, on squares and in courtyards.
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "plan.h"
#include "relief.h"

namespace sightcell::city {

struct named_cell {
  std::string name;
  glm::dvec3 min{0, 0, 0}, max{0, 0, 0};
  bool has_tree = false;  // a tree stands in it; else nothing does
};

inline constexpr std::size_t cell_count = 20;

// At most cell_count: cities of one or two blocks have fewer places.
std::vector<named_cell> choose_cells(const plan& p, std::uint64_t seed);

// The same over a relief, with bridges, sunken streets and passages among the places.
std::vector<named_cell> choose_town_cells(const plan& p, const relief& r, std::uint64_t seed);

// The plan of a cell, grown to all sides.
ring cell_ring(const named_cell& cell, double grown);

}  // namespace sightcell::city
