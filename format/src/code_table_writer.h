#pragma once
// Writes the lengths of a prefix code. The counterpart for reading is code_table.h.
#include <cstddef>
#include <vector>

#include "code_lengths.h"

namespace sightcell::format {

// Appends.
void put_code_lengths(const symbol_lengths& lengths, std::vector<std::byte>& out);

}  // namespace sightcell::format
