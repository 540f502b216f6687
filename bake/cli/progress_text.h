#pragma once
// The text of the progress line. It never takes more columns than it is given: what matters least is left out first.
#include <cstddef>
#include <string>
#include <string_view>

#include "sightcell/bake/progress.h"

namespace sightcell::cli {

// Returns the name of a phase in JSON: "baking_cells".
std::string_view phase_name(bake::bake_phase phase);
// Returns the name of a phase on the line: "baking cells".
std::string_view phase_text(bake::bake_phase phase);
// Returns true if progress_text has a count or a percentage for the phase, and not its name alone.
bool is_counted(bake::bake_phase phase);

// Returns the line of a bake: "baking cells: 1 of 60, 18 min left, cell 2 (-122, 7, -90) m for 34 s".
// width: columns.
std::string progress_text(const bake::progress& now, std::size_t width);
// Returns the line of a bake that is about to stop: "stopping after 2 cells in work, cell 2 (-122, 7, -90) m for 34 s".
std::string stopping_text(const bake::progress& now, std::size_t width);
// Returns the line of work that is not counted, from the third second on with its time: "loading level.glb, 12 s".
std::string waiting_text(const std::string& what, double seconds, std::size_t width);

// Returns the text without what exceeds the width. Control characters become spaces. A character outside ASCII counts
// as two columns, because some take that many.
std::string cut_to(std::string_view text, std::size_t width);

// Returns true if this is the last progress of all cells, or of their importance.
bool is_last(const bake::progress& now);

}  // namespace sightcell::cli
