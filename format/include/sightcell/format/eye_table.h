#pragma once
// The eyes of a file (SPEC.md, "Eyes"): a few valid viewpoints of each cell, for hosts and tools that need a camera
// position. reader::open skips them. The counterpart for writing is eye_table_writer.h.
#include <array>
#include <cstdint>

#include "sightcell/format/packed_columns.h"
#include "sightcell/format/reader.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// The position of an eye, in meters: inside the box of its cell. Equal on all machines.
[[nodiscard]] std::array<float, 3> eye_position(const box& cell, const eye_steps& eye) noexcept;

// The eye whose step contains a position; for a position outside the box, that of the nearest step.
[[nodiscard]] eye_steps eye_at(const box& cell, const std::array<float, 3>& position) noexcept;

// A view of the section: cheap to copy, valid as long as the bytes are. Default-constructed: no eyes.
class eye_table {
 public:
  // Opens the section of a file. out: set only on ok. absent: the file has none; checksum; corrupt. O(cells).
  [[nodiscard]] static status open(const reader& file, eye_table& out) noexcept;

  // The number of eyes of a cell, 0 .. max_eyes; 0 for a cell that does not exist, or if the bytes changed since open.
  [[nodiscard]] std::uint32_t count(std::uint32_t cell) const noexcept;

  // number: below count(cell). argument: no such eye.
  [[nodiscard]] status eye(std::uint32_t cell, std::uint32_t number, eye_steps& out) const noexcept;

 private:
  // The number of eyes of all cells before this one.
  [[nodiscard]] std::uint32_t begin(std::uint32_t cell) const noexcept { return cell == 0 ? 0 : ends_[cell - 1]; }

  packed_column ends_;
  std::array<packed_column, 3> steps_;
  std::uint32_t cells_ = 0;
};

}  // namespace sightcell::format
