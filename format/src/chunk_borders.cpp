#include "sightcell/format/chunk_borders.h"

#include <algorithm>
#include <bit>

#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

constexpr std::uint32_t block_cells = layout::cells_per_block;

std::uint32_t blocks_of(std::uint32_t cells) noexcept {
  return (cells + block_cells - 1) / block_cells;
}

// The bits 0 .. last.
std::uint64_t bits_up_to(std::uint32_t last) noexcept {
  return ~std::uint64_t{0} >> (block_cells - 1 - last);
}

}  // namespace

chunk_borders::chunk_borders(std::uint32_t cells) noexcept : cells_(cells), chunks_(blocks_of(cells)) {}

std::uint64_t chunk_borders::begins_in(std::uint32_t block) const noexcept {
  if (!stored_) return 1;
  return std::uint64_t{columns_[column_mask_high][block]} << 32 | columns_[column_mask_low][block];
}

bool chunk_borders::open(std::span<const std::byte> bytes, std::uint32_t cells) noexcept {
  chunk_borders made(cells);
  const std::uint32_t blocks = blocks_of(cells);
  if (!open_columns(bytes, blocks, made.columns_)) return false;
  made.stored_ = true;
  std::uint32_t next = 0;
  for (std::uint32_t block = 0; block < blocks; ++block) {
    const std::uint64_t begins = made.begins_in(block);
    const std::uint32_t last = std::min(cells - block * block_cells, block_cells) - 1;
    if (made.columns_[column_first][block] != next || (begins & 1) == 0) return false;
    if ((begins & ~bits_up_to(last)) != 0) return false;
    next += count_bits(begins);
  }
  made.chunks_ = next;
  *this = made;
  return true;
}

cell_chunk chunk_borders::chunk_of(std::uint32_t cell) const noexcept {
  const std::uint32_t block = cell / block_cells;
  const std::uint32_t place = cell % block_cells;
  const std::uint32_t block_begin = block * block_cells;
  const std::uint64_t begins = begins_in(block) | 1;
  const std::uint64_t before = begins & bits_up_to(place);
  const std::uint64_t behind = begins & ~bits_up_to(place);
  const std::uint32_t first = stored_ ? columns_[column_first][block] : block;
  const auto begin = block_begin + static_cast<std::uint32_t>(std::bit_width(before)) - 1;
  const auto end = behind == 0 ? block_cells : static_cast<std::uint32_t>(std::countr_zero(behind));
  const std::uint32_t number = first + count_bits(before) - 1;
  return {std::min(number, chunks_ - 1), begin, std::min(block_begin + end, cells_) - begin};
}

}  // namespace sightcell::format
