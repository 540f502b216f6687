#pragma once
// View cells: the boxes in which a camera can be.
#include <array>
#include <compare>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sightcell/bake/settings.h"
#include "sightcell/base/stop_request.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// A position on the lattice. Cells are sorted by z, then y, then x, the order of the members. A cell of level l is 2^l
// times as wide and deep as one of level 0 and covers 2^l x 2^l of them. It reaches over `layers` layers from y up.
struct lattice_position {
  std::int64_t z = 0, y = 0, x = 0;
  std::int32_t level = 0;
  std::int32_t layers = 1;
  auto operator<=>(const lattice_position&) const = default;
};

struct view_cell {
  glm::vec3 min{0.0f}, max{0.0f};  // meters; half-open; without the margin
  std::string name;                // from a cells file or the scene, else empty
  // Names the random numbers of the cell: a hash of its lattice position, or of the six coordinates of its box.
  std::uint64_t place = 0;
  std::uint32_t number = 0;  // of explicit cells: index in the list that was given
  bool on_lattice = false;
  lattice_position position{};  // of lattice cells
  // Of automatic cells: square meters of reached floor whose eyes are in the cell. Of one in a box of --fly or near a
  // path: those of the cell.
  double floor_area = 0.0;
  // Meters: of automatic cells the median height of this floor; of others the bottom of the box.
  double floor = 0.0;
};

struct cell_list {
  std::vector<view_cell> cells;
  std::string how;                    // one line for messages: "1,204 cells of 4 m over walkable floor"
  std::string where;                  // its end, for lists that are made from this one: "over walkable floor"
  bool can_merge = false;             // automatic cells over floors and of flight, all of level 0
  double cell_width = 0.0;            // meters: of the lattice, where can_merge
  bool of_scene = false;              // explicit cells that the scene contains
  std::vector<std::string> warnings;  // one line each
};

// Returns the cells that settings request: the host's own, else those of --cells-file, else --cells-grid, else those
// that the scene contains unless flies(how), else automatic cells.
// Automatic cells are boxes around the eyes of players above the floors that can be reached (walkable.h), and the cells
// of flight (flight.h), which may overlap these. They are cell_size wide and deep, on a lattice that is anchored at the
// world origin. Over floors they are as high as the eyes require, else half as high as wide. If there are none, they
// are a grid over the bounding box grown by 2 m.
// --cell-limit is applied. Whether a cell has a valid viewpoint is not tested here. Deterministic.
// Throws sightcell::error (bad_input) on a broken cells file.
cell_list make_cells(const scene::world_geometry& geometry, const settings& how);
// The same in two steps: make_all_cells() ignores --cell-limit, and limit_cells() keeps `limit` cells: those nearest to
// a point in the order of the list, or without one such that are spread evenly over the list. A limit of 0 keeps all.
// stop: null for none. Throws step_stopped if it was asked.
cell_list make_all_cells(const scene::world_geometry& geometry, const settings& how,
                         const stop_request* stop = nullptr);
void limit_cells(cell_list& list, std::uint32_t limit, const std::optional<std::array<float, 3>>& near = {});
// Returns the distance of a point from the box of a cell, meters.
float distance_of(const view_cell& cell, const std::array<float, 3>& point);

}  // namespace sightcell::bake
