#pragma once
// Writes tables of u32. The counterpart for reading, packed_columns.h, describes them.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

// Appends the table. All columns have the same number of values.
void put_columns(std::span<const std::vector<std::uint32_t>> columns, std::vector<std::byte>& out);

}  // namespace sightcell::format
