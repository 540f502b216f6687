#pragma once
// A town of exactly as many polygons as asked for, the same on every machine for the same numbers.
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "cells.h"
#include "mesh.h"
#include "style.h"

namespace sightcell::city {

inline constexpr std::uint64_t fewest_polygons = 500;
inline constexpr std::uint64_t most_polygons = 100'000'000;

struct node {
  std::string name;
  std::uint32_t mesh = 0xFFFFFFFFu;  // none: a group
  glm::dvec3 translation{0, 0, 0};
  glm::dvec2 turn{0, 1};  // y and w of the rotation's unit quaternion
  glm::dvec2 tilt{0, 0};  // its x and z
  double scale = 1.0;
  std::vector<std::uint32_t> children;
};

struct model {
  std::vector<mesh> meshes;
  std::vector<node> nodes;
  std::vector<std::uint32_t> roots;
  std::vector<named_cell> cells;
  std::size_t surface_count = plain_surface_count;  // the file has materials for so many
};

// Throws sightcell::error (wrong_use) when polygons is not in fewest_polygons..most_polygons.
model make_city(std::uint64_t polygons, std::uint64_t seed);

// The same in a richer style: relief, bridges, covered passages, clutter. About style.polygons_per_block is the least.
model make_town(const style& s, std::uint64_t polygons, std::uint64_t seed);

std::uint64_t count_polygons(const model& m);

}  // namespace sightcell::city
