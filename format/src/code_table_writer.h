#pragma once
// Lengths of a prefix code -> bytes. code_table.h is the way back.
#include <cstddef>
#include <vector>

#include "code_lengths.h"

namespace sightcell::format {

// Appends.
void put_code_lengths(const symbol_lengths& lengths, std::vector<std::byte>& out);

}  // namespace sightcell::format
