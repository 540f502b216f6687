#pragma once
// The counterpart of viewpoint_table.h for writing.
#include <cstddef>
#include <vector>

#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// Appends the section. The cells have been checked. argument: the records are not one per cell in cell order, a number
// is out of its range, or a region is no valid tree; limit: too many bytes.
status put_viewpoints(const file_contents& contents, std::vector<std::byte>& out);

}  // namespace sightcell::format
