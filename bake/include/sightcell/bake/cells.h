#pragma once
// The view cells of a bake, before it. bake.h has the conventions.
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sightcell/bake/progress.h"
#include "sightcell/bake/settings.h"

namespace sightcell::scene {
struct scene;  // sightcell/scene/scene.h
}

namespace sightcell::bake {

// Cells of one storey, or of one slope: hardly any of them is above another.
struct cell_floor {
  std::vector<std::uint32_t> cells;    // indices in cell_preview::cells, ascending
  double lowest = 0.0, highest = 0.0;  // meters: heights of the ground below the cells
};

// What bake() would bake.
struct cell_preview {
  std::vector<cell_box> cells;        // without the margin; in the order of the bake
  std::vector<double> ground;         // meters, one per cell: of automatic cells the median height of the floor that a
                                      // player reaches there, of others the bottom of the box
  std::vector<cell_floor> floors;     // from the lowest up; each cell is in one; at most most_floors
  std::string how;                    // one line: how many cells, their width, and how they were chosen
  std::vector<std::string> warnings;  // one line each
  double cpu_seconds = 0.0;           // estimated: of a bake of these cells, on all threads together
  double polygons_per_cell = 0.0;     // estimated: the mean size of the cell sets
  std::optional<double> file_bytes;   // estimated; nothing for samplers without hemicubes
};

inline constexpr std::size_t most_floors = 12;

// Returns the cells that the settings request (settings::cells_file and the options after it).
// s: the scene.
// how: as for bake(). What is about sampling decides the estimates, and whether cells are merged, which is done by
//   hemicubes (settings::merge_cells).
// events: on_phase is called, and on_progress while cells are merged and tried; they may be empty.
// Returns nothing if events.on_progress cancels.
// Fails with settings.* and cells.*, with bake.nothing-to-see, and as the source does.
// Cost: some seconds and some hundred megabytes for the voxels of automatic cells, and what a bake needs for the scene.
//   Five hemicubes per cell before they are merged, and some trial cells, of up to ten seconds, for the
//   estimates. Whether a cell has valid viewpoints is not tested: the bake leaves out those that have none.
std::optional<cell_preview> preview_cells(const scene::scene& s, const settings& how, const callbacks& events);

// Returns the last point of the last path of a path file, in meters: where a camera was last.
// Fails with path.*.
std::array<float, 3> last_point(const std::filesystem::path& path_file);

}  // namespace sightcell::bake
