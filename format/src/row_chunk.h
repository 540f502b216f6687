#pragma once
// The rows of up to 64 cells, which are decoded without any others (SPEC.md, "Rows"): where each row begins, and its
// contents: own runs, or the difference to the set of a reference cell of the same chunk. The counterpart for writing
// is row_chunk_encoder.h.
#include <cstddef>
#include <cstdint>
#include <span>

#include "bit_reader.h"
#include "rank_difference.h"
#include "run_code.h"
#include "sightcell/format/cluster_table.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The codes of the three kinds of lists; about 62 KiB. And where clusters begin, in the memory behind this.
struct row_codes {
  run_code own, removed, added;
  cluster_borders clusters;
};

// Bounds of all sets of a file: the room that decoding needs.
struct row_bounds {
  std::uint32_t limit = 0;      // sets contain numbers below this one
  std::uint32_t runs = 0;       // the most of any set
  std::uint32_t list_runs = 0;  // the most of any list of a difference

  // Numbers of one set and one list.
  [[nodiscard]] constexpr std::size_t set_room() const noexcept {
    return rank_difference_room(2 * std::size_t{runs}, 2 * std::size_t{list_runs}, 2 * std::size_t{list_runs});
  }
  [[nodiscard]] constexpr std::size_t list_room() const noexcept { return 2 * std::size_t{list_runs} + list_padding; }
  // Numbers of scratch that decoding needs.
  [[nodiscard]] constexpr std::size_t scratch_room() const noexcept { return 2 * set_room() + 2 * list_room(); }
};

// How a row is coded.
struct row_head {
  bool delta = false;
  std::uint32_t reference = 0;     // index of the reference cell in the chunk; only where delta
  std::uint32_t first_count = 0;   // own runs, or runs that are removed
  std::uint32_t second_count = 0;  // runs that are added; 0 for own rows
  bit_reader lists;                // at the begin of the first list
};

class row_chunk {
 public:
  // A chunk without rows.
  row_chunk() noexcept = default;
  // bytes: the chunk and nothing after it; not copied. rows: 1 .. 64. False if they cannot contain the table of rows.
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t rows) noexcept;

  [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }
  // Where a row begins and the rows end, in bytes from the begin of the first row.
  [[nodiscard]] std::uint64_t begin_of(std::uint32_t place) const noexcept;
  [[nodiscard]] std::uint64_t end_of_rows() const noexcept { return size_; }

  // False if there is no such row, or its first bits are invalid.
  [[nodiscard]] bool head(std::uint32_t place, row_head& out) const noexcept;

  // Decodes the set of a cell of the chunk, given by its index: the borders of its runs, in scratch, valid until the
  // next use. end: the end of the row, as begin_of counts. Follows up to max_reference_depth references. scratch:
  // bounds.scratch_room() numbers. capacity: scratch is too small; corrupt: an invalid row, or one that breaks the
  // bounds. Allocates nothing.
  status decode(std::uint32_t place, const row_codes& codes, const row_bounds& bounds, std::span<std::uint32_t> scratch,
                std::span<const std::uint32_t>& borders, std::uint64_t& end) const noexcept;

 private:
  std::span<const std::byte> bytes_;  // rows and padding
  bit_reader table_;                  // at the first entry of the table
  unsigned table_bits_ = 0;           // of one entry
  std::uint32_t rows_ = 0;
  std::uint64_t size_ = 0;  // of the rows without padding
};

// Reads a count of runs: its number of bits, in five bits, then these bits without the first, which is a one.
[[nodiscard]] inline std::uint32_t take_count(bit_reader& in) noexcept {
  const std::uint32_t bits = in.take(5);
  return bits == 0 ? 0 : std::uint32_t{1} << (bits - 1) | in.take(bits - 1);
}

}  // namespace sightcell::format
