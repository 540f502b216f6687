#pragma once
// The counterpart of named_group_table.h for writing.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Appends the section. argument: a name is empty or occurs twice, or a draw is in a group that does not exist; limit:
// too many bytes.
status put_named_groups(std::span<const std::string> names, std::span<const draw_record> draws,
                        std::vector<std::byte>& out);

}  // namespace sightcell::format
