#pragma once
// Where a tile is, and how much of a picture is missing without it.
#include <array>
#include <glm/vec3.hpp>
#include <limits>
#include <span>

#include "sightcell/scene/stream_pages.h"
#include "stream/shown_draws.h"

namespace sightcell::bake {

struct tile_box {
  glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

  bool is_empty() const { return !(min.x <= max.x); }
  void add(const tile_box& other) { min = glm::min(min, other.min), max = glm::max(max, other.max); }
};

struct tile_shape {
  tile_box box;       // in the world, Y up; a little larger than the polygons, because viewers compute with floats
  double size = 0.0;  // meters: the side of a square as large as the surface of the page
};

// parts: of a page. Cost: O(polygons of all their draws).
tile_shape shape_of(const scene::gltf_pager& pager, const shown_draws& shown, std::span<const scene::page_part> parts);

}  // namespace sightcell::bake
