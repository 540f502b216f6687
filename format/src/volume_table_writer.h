#pragma once
// Volumes -> bytes. volume_table.h is the way back.
#include <cstddef>
#include <vector>

#include "sightcell/format/writer.h"

namespace sightcell::format {

// Appends the volumes section. argument, and nothing appended: no volume can lie at one of the places, two are the
// same, or there is no lattice.
status put_volumes(const lattice_volumes& volumes, std::vector<std::byte>& out);

}  // namespace sightcell::format
