#pragma once
// Encodes the rows of one chunk: chooses for every cell whether its row stands alone, is the difference to another
// cell of the chunk, or is shared with an earlier cell.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

struct encoded_row {
  std::uint64_t offset = 0;  // inside the chunk
  std::uint64_t size = 0;
};

struct encoded_chunk {
  std::vector<std::byte> bytes;
  std::vector<encoded_row> rows;  // one per cell; cells with equal sets have the same one
};

// sets: the runs of 1 .. 64 consecutive cells. Same sets, same bytes. Allocates; any thread.
encoded_chunk encode_chunk(std::span<const std::vector<run>> sets, std::uint32_t polygon_count);

}  // namespace sightcell::format
