#pragma once
// A town of exactly as many polygons as asked for, the same on every machine for the same numbers.
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "cells.h"
#include "mesh.h"

namespace sightcell::city {

inline constexpr std::uint64_t fewest_polygons = 500;
inline constexpr std::uint64_t most_polygons = 100'000'000;

struct node {
  std::string name;
  std::uint32_t mesh = 0xFFFFFFFFu;  // none: a group
  glm::dvec3 translation{0, 0, 0};
  glm::dvec2 turn{0, 1};  // y and w of the rotation's unit quaternion
  double scale = 1.0;
  std::vector<std::uint32_t> children;
};

struct model {
  std::vector<mesh> meshes;
  std::vector<node> nodes;
  std::vector<std::uint32_t> roots;
  std::vector<named_cell> cells;
};

// Throws sightcell::error (wrong_use) when polygons is not in fewest_polygons..most_polygons.
model make_city(std::uint64_t polygons, std::uint64_t seed);

}  // namespace sightcell::city
