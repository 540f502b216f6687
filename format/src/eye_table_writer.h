#pragma once
// Writes the eyes of cells. The counterpart for reading is eye_table.h.
#include <cstddef>
#include <vector>

#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// Appends the section, or nothing if no cell has an eye. argument: too many eyes in a cell, or a step that is outside.
status put_eyes(const file_contents& contents, std::vector<std::byte>& out);

}  // namespace sightcell::format
