#pragma once
// Writes volumes. The counterpart for reading is volume_table.h.
#include <cstddef>
#include <vector>

#include "sightcell/format/writer.h"

namespace sightcell::format {

// Appends the volumes section. argument, and nothing appended: a position is invalid, two are equal, or there is no
// lattice.
status put_volumes(const lattice_volumes& volumes, std::vector<std::byte>& out);

}  // namespace sightcell::format
