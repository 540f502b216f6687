#pragma once
// Divides the cells of a block into chunks, and writes where these begin. The counterpart for reading is
// chunk_borders.h.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "row_chunk_encoder.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

// A chunk before it is encoded.
struct planned_chunk {
  std::uint32_t first = 0;  // of its cells, by index in the block
  std::uint32_t cells = 0;
  chunk_plan plan;

  // Its own of the elements of the cells of the block.
  template <class Element>
  [[nodiscard]] std::span<Element> part(std::vector<Element>& of_block) const {
    return std::span(of_block).subspan(first, cells);
  }
};

// The chunks of a block, in the order of its cells: one, or as many as it takes so that each with more than one cell
// has no more than most_bytes by the expected costs of its rows. sets: of the 1 .. 64 cells of the block. encoders,
// limit, how: as for plan_chunk. Equal arguments give equal chunks. Allocates; any thread. Cost: that of plan_chunk
// for the block, and for its parts.
std::vector<planned_chunk> split_block(std::span<const std::vector<run>> sets, const row_encoders& encoders,
                                       std::uint32_t limit, std::uint64_t most_bytes,
                                       const plan_settings& how = {});

// The section. Empty if each block is one chunk: then a file has none.
std::vector<std::byte> encode_borders(std::span<const std::vector<planned_chunk>> blocks);

}  // namespace sightcell::format
