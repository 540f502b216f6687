#pragma once
// The rows of up to 64 cells, which are decoded without any others (SPEC.md, "Rows"): where each row
// begins, and what it says: its own runs, or the difference to the set of a reference cell of the same chunk.
// row_chunk_encoder.h is the way back.
#include <cstddef>
#include <cstdint>
#include <span>

#include "bit_reader.h"
#include "rank_difference.h"
#include "run_code.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The codes of the three kinds of lists; about 62 KiB.
struct row_codes {
  run_code own, removed, added;
};

// What all sets of a file keep to: the room that decoding needs.
struct row_bounds {
  std::uint32_t limit = 0;      // sets are of numbers below this one
  std::uint32_t runs = 0;       // the most of any set
  std::uint32_t list_runs = 0;  // the most of any list of what is removed or added

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
  std::uint32_t reference = 0;     // place of the reference cell in the chunk; only where delta
  std::uint32_t first_count = 0;   // own runs, or runs that are removed
  std::uint32_t second_count = 0;  // runs that are added; 0 for own rows
  bit_reader lists;                // stands before the first list
};

class row_chunk {
 public:
  // A chunk without rows.
  row_chunk() noexcept = default;
  // bytes: the chunk and nothing behind it; viewed. rows: 1 .. 64. False when they cannot hold the table of rows.
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t rows) noexcept;

  [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }
  // Where a row begins and the rows end: bytes from the first one of the first row.
  [[nodiscard]] std::uint64_t begin_of(std::uint32_t place) const noexcept;
  [[nodiscard]] std::uint64_t end_of_rows() const noexcept { return size_; }

  // False when there is no such row, or its first bits make none.
  [[nodiscard]] bool head(std::uint32_t place, row_head& out) const noexcept;

  // The set of the cell at place: the borders of its runs, in scratch, until that is used again. end: of the row, as
  // begin_of counts. At most max_reference_depth references are followed. scratch: bounds.scratch_room() numbers.
  // capacity: scratch is too small; corrupt: the row is none, or breaks the bounds. Allocates nothing.
  status decode(std::uint32_t place, const row_codes& codes, const row_bounds& bounds, std::span<std::uint32_t> scratch,
                std::span<const std::uint32_t>& borders, std::uint64_t& end) const noexcept;

 private:
  std::span<const std::byte> bytes_;  // rows and padding
  bit_reader table_;                  // stands before the first place
  unsigned table_bits_ = 0;           // of one place
  std::uint32_t rows_ = 0;
  std::uint64_t size_ = 0;  // of the rows without padding
};

// A count of runs: how many bits it has, in five, then these bits but the first, which is a one.
[[nodiscard]] inline std::uint32_t take_count(bit_reader& in) noexcept {
  const std::uint32_t bits = in.take(5);
  return bits == 0 ? 0 : std::uint32_t{1} << (bits - 1) | in.take(bits - 1);
}

}  // namespace sightcell::format
