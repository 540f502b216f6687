#pragma once
// Views from the cells of a .pvs file, for pictures of them. bake.h has the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "sightcell/bake/cells.h"
#include "sightcell/bake/settings.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// A valid viewpoint of a cell, and what is around it. Distances are in meters.
struct cell_view {
  std::uint32_t cell = 0;
  std::array<float, 3> eye{};  // uniform in the region of the cell that its certificate is about
  std::array<float, 3>
      target{};  // of what is visible in 16 level directions, the farthest; 10 m ahead if there is none
  float above = std::numeric_limits<float>::infinity();  // to the first occluder straight up; infinity: the open sky
  float below = std::numeric_limits<float>::infinity();  // straight down
};

// Returns a view from each of some cells of a file. Cells in which no valid viewpoint is found have none.
// s: the scene that was baked.
// cells_from: the scene of the cells, for files that were baked with settings::cells_from; else null.
// file: the bytes of the .pvs file.
// name: of the file, for messages.
// cells: numbers of cells in the file, each less than its number of cells.
// seed: of the random viewpoints. The result depends on nothing else.
// Fails with pvs.broken, pvs.other-scene, pvs.two-scenes.
// Cost: flattens the scene, builds a ray scene, and casts some hundred rays per cell, on all cores.
std::vector<cell_view> find_cell_views(const scene::scene& s, const scene::scene* cells_from,
                                       std::span<const std::byte> file, const std::string& name,
                                       std::span<const std::uint32_t> cells, std::uint64_t seed);

// Divides the cells of a file into floors, from the lowest up. Heights are those of the bottoms of boxes.
// cells: without the margin.
// over_floors: the cells were placed over the floors of the scene, and not by a caller.
// Returns at most most_floors floors; each cell is in one.
std::vector<cell_floor> floors_of_cells(std::span<const cell_box> cells, bool over_floors);

}  // namespace sightcell::bake
