#pragma once
// A bake of what is visible of one scene from the cells of another (--cells-from). Both are in one world, and sets
// have only polygons of the first scene. Its polygons come first and keep their source ids. The polygons after them
// are visible, occlude and make viewpoints invalid, but are in no set.
#include <optional>
#include <string>
#include <string_view>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// The key under which the settings text of a file has the fingerprint of the scene of the cells.
inline constexpr const char* cells_from_member = "cells_from";
// Returns the fingerprint as hexadecimal digits.
std::string fingerprint_text(const scene::scene& s);
// Returns the fingerprint of the scene of the cells; nothing if cells and polygons are of one scene.
std::optional<std::string> stored_cells_from(std::string_view settings);

// Throws sightcell::error (wrong_use), because surface colors are available for one scene only.
[[noreturn]] void refuse_colors_of_two_scenes(const char* option);

// Appends the polygons of another scene to geometry; the bounds become those of both. Polygons that duplicate one of
// geometry exactly become absent, since they are visible when it is. Levels of detail that only sets contain are left
// out.
// other_name: for messages.
// Throws sightcell::error if there are too many polygons or vertices.
void append(scene::world_geometry& geometry, scene::world_geometry&& other, bool all_double_sided,
            const std::string& other_name);

}  // namespace sightcell::bake
