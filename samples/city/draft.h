#pragma once
// A city before its meshes are built: what stands where, and how much detail each thing has been given so far.
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "building.h"
#include "cells.h"
#include "plan.h"
#include "props.h"

namespace sightcell::city {

struct block_draft {
  std::vector<building> houses;
  std::vector<prop_place> fixed_props;
  std::vector<prop_place> props;  // the first props_used of them stand
  std::size_t props_used = 0;
  std::vector<std::array<glm::dvec2, 2>> pickets;  // of the fence in the yard; the first pickets_used stand
  std::size_t pickets_used = 0;
  ring lawn{};
  bool has_lawn = false;
};

struct draft {
  plan layout;
  std::vector<named_cell> cells;
  std::vector<block_draft> blocks;  // as layout.blocks
  std::vector<mesh> prop_meshes;
  bool plain = false;              // the smallest cities: bare walls, no town wall
  bool has_extra_polygon = false;  // one more in the ground: everything else comes in even numbers
};

inline constexpr double town_wall_height = 9.0;

draft make_draft(std::uint32_t rows, std::uint32_t columns, bool plain, std::uint64_t seed);

std::uint64_t base_polygons(const draft& d);      // with no detail at all
std::uint64_t possible_polygons(const draft& d);  // with all detail

// Adds detail, spread evenly over the city, until there are exactly `polygons`. False when it cannot.
bool spend(draft& d, std::uint64_t polygons, std::uint64_t seed);

}  // namespace sightcell::city
