#pragma once
// Which cells form a chunk (SPEC.md, "Chunk borders"). A chunk is some consecutive cells of one block; a block is 64
// consecutive cells. Chunks of rows and chunks of importance classes have the same cells. The counterpart for writing
// is in chunk_split.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/packed_columns.h"

namespace sightcell::format {

// The number of bits that are 1. std::popcount is a call into another library where the processor may lack an
// instruction for it.
[[nodiscard]] constexpr std::uint32_t count_bits(std::uint64_t v) noexcept {
  v -= v >> 1 & 0x5555555555555555u;
  v = (v & 0x3333333333333333u) + (v >> 2 & 0x3333333333333333u);
  v = (v + (v >> 4)) & 0x0F0F0F0F0F0F0F0Fu;
  return static_cast<std::uint32_t>(v * 0x0101010101010101u >> 56);
}

// The cells of one chunk.
struct cell_chunk {
  std::uint32_t number = 0;
  std::uint32_t first_cell = 0;
  std::uint32_t cells = 0;  // 1 .. 64

  [[nodiscard]] std::uint32_t end() const noexcept { return first_cell + cells; }
};

// A view of the section, valid as long as its bytes are. Const functions may run on any number of threads at once.
class chunk_borders {
 public:
  // Of a file without cells.
  chunk_borders() noexcept = default;

  // Of a file without the section: each block is a chunk.
  explicit chunk_borders(std::uint32_t cells) noexcept;

  // Opens the section. bytes: the section and nothing after it; not copied. cells: of the file. False, and unchanged,
  // unless the chunks are as SPEC.md requires. O(cells / 64).
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t cells) noexcept;

  [[nodiscard]] std::uint32_t cells() const noexcept { return cells_; }
  [[nodiscard]] std::uint32_t chunks() const noexcept { return chunks_; }

  // The chunk of a cell, which is below cells(). If the bytes changed since they were opened, some chunk with this
  // cell, whose number is below chunks(). O(1).
  [[nodiscard]] cell_chunk chunk_of(std::uint32_t cell) const noexcept;

 private:
  // In the order of the file.
  enum column { column_first, column_mask_low, column_mask_high, columns };

  [[nodiscard]] std::uint64_t begins_in(std::uint32_t block) const noexcept;

  std::uint32_t cells_ = 0;
  std::uint32_t chunks_ = 0;
  bool stored_ = false;
  std::array<packed_column, columns> columns_;
};

}  // namespace sightcell::format
