#pragma once
// A scene and, where there is one, the .pvs file baked from it, in the form in which the viewer keeps them.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "draw_lists.h"
#include "sightcell/scene/scene.h"
#include "sightcell/sightcell.hpp"

namespace viewer {

// The id of the error of open_baked() for a file of another scene, or of another version of it.
inline constexpr const char* other_scene = "viewer.other-scene";

struct cell {
  glm::vec3 min, max;
  std::string name;     // empty when nobody said one
  glm::vec3 eye{0.0f};  // a valid viewpoint, or the middle where the file has none
};

struct baked_scene {
  std::string scene_name, pvs_name;  // pvs_name is empty without a file
  std::optional<sightcell::db> db;
  std::vector<cell> cells;
  std::vector<float> bounds;  // of the miss probability, by cell; empty if the file has none
  float margin = 0.0f;        // meters by which cells were grown for the bake
  std::size_t range_bound = 0;
  std::vector<sightcell_draw> draws;          // what ranges count in: of the file, or made from the scene
  std::vector<std::uint32_t> stored_indices;  // into the flattened vertices, three per polygon in stored order
  std::uint32_t polygon_count = 0;
  glm::vec3 min{0.0f}, max{0.0f};
};

// s: its geometries and images are not read. pvs_file, cells_file (which gives cells their names): may be empty. Throws
// sightcell::error (bad_input) with one line when a file is broken or was baked from another scene.
baked_scene open_baked(const sightcell::scene::scene& s, const sightcell::scene::world_geometry& world,
                       const std::string& pvs_file, const std::string& cells_file);

// The cell to go to from an eye in cell `here`: `steps` on from the one visited last while the eye is still in its box
// (a smaller cell may lie over its middle: going on from `here` could go in circles), else from here. There are cells.
std::uint32_t cell_after(std::span<const cell> cells, std::uint32_t visited, std::uint32_t here, const glm::vec3& eye,
                         int steps);

// The draw table of a merged file as its ranges count: each draw group as one draw, that is like its first one.
std::vector<sightcell_draw> joined_groups(std::span<const sightcell_draw> draws);

// A whole scene as ranges.
std::vector<sightcell_range> all_ranges(std::span<const sightcell_draw> draws);

// The flags of a frame in words, "-" for none.
std::string flags_text(std::uint32_t flags);

}  // namespace viewer
