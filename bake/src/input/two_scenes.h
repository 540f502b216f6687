#pragma once
// A bake of what the cells of one scene see of another: both stand in one world, and sets have polygons of the second
// alone. Those come first, so that they keep their source ids; what comes behind them is seen, hides and keeps eyes
// off, and is in no set.
#include <optional>
#include <string>
#include <string_view>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// The settings text of a file names the scene of its cells by its fingerprint under this name.
inline constexpr const char* cells_from_member = "cells_from";
std::string fingerprint_text(const scene::scene& s);
// Nothing where cells and polygons are of one scene.
std::optional<std::string> stored_cells_from(std::string_view settings);

// Throws sightcell::error (wrong_use): surface colors are those of one scene.
[[noreturn]] void refuse_colors_of_two_scenes(const char* option);

// Puts the polygons of another scene behind those of geometry; bounds are those of both. Exact duplicates of what is
// there already become absent: one seen, all seen. Levels of detail that only sets ask for are left out. other: its
// name, for messages. Throws sightcell::error where there would be too many.
void append(scene::world_geometry& geometry, scene::world_geometry&& other, bool all_double_sided,
            const std::string& other_name);

}  // namespace sightcell::bake
