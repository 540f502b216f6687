#pragma once
// The way back from named_group_table.h.
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Appends the section. argument: a name is empty or there twice, or a draw is in a group that there is not; limit: too
// many bytes.
status put_named_groups(std::span<const std::string> names, std::span<const draw_record> draws,
                        std::vector<std::byte>& out);

}  // namespace sightcell::format
