#pragma once
// Tables of u32 -> bytes. packed_columns.h is the way back and says what they are.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

// Appends the table. All columns have as many values as the first one.
void put_columns(std::span<const std::vector<std::uint32_t>> columns, std::vector<std::byte>& out);

}  // namespace sightcell::format
