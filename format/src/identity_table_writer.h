#pragma once
// Writes the draw identity. The counterpart for reading is identity_table.h.
#include <cstddef>
#include <vector>

#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// Appends the section, or nothing if there are no hashes. argument: not one hash for each draw with polygons, or a name
// with a zero byte.
status put_identity(const file_contents& contents, std::vector<std::byte>& out);

}  // namespace sightcell::format
