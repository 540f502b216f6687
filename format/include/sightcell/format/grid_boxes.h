#pragma once
// View cells that are boxes of whole steps of a grid (SPEC.md, "Cells"). The counterpart for writing is
// grid_boxes_writer.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

// The box in meters. Boxes that meet at a step share exact floats. Not checked by box_is_valid().
[[nodiscard]] box box_of(const lattice_shape& step, const grid_box& place) noexcept;

class grid_boxes {
 public:
  // No cells.
  grid_boxes() noexcept = default;

  // Opens a section. bytes: from the width of a step on, and nothing after the last row; not copied. False, and
  // unchanged, unless the size of a step is valid and there are exactly `cells` rows. Does not check that their boxes
  // are valid. O(1).
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t cells) noexcept;

  [[nodiscard]] const lattice_shape& step() const noexcept { return step_; }

  // The place of a cell; any place for a cell that does not exist. O(1).
  [[nodiscard]] grid_box place(std::uint32_t cell) const noexcept;

 private:
  // In the order of the file.
  enum column { column_x, column_y, column_z, column_steps_x, column_steps_y, column_steps_z, columns };

  lattice_shape step_;
  std::array<packed_column, columns> columns_;
};

}  // namespace sightcell::format
