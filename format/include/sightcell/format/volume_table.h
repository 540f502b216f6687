#pragma once
// Visibility volumes (SPEC.md, "Volumes"): boxes on a lattice that are members of sets like polygons, and that nothing
// draws. The counterpart for writing is volume_table_writer.h.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/layout.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Whether a volume may be at a position: the coordinates are those of cells of level 0, and the box is valid.
[[nodiscard]] bool is_volume_place(const lattice_shape& shape, const lattice_place& place) noexcept;

class volume_table {
 public:
  // A table without volumes.
  volume_table() noexcept = default;

  // Opens a section. bytes: the section and nothing after it; not copied. polygons: of the file. out: set only on ok.
  // limit: too many volumes; corrupt: no volume, no lattice, or an invalid position. places_differ() tests that no two
  // have the same position. O(volumes).
  static status open(std::span<const std::byte> bytes, std::uint32_t polygons, volume_table& out) noexcept;

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }

  // The size of a volume.
  [[nodiscard]] const lattice_shape& shape() const noexcept { return shape_; }

  // The position of a volume, on level 0, and its box; read and checked again. False if there is no such volume, or the
  // bytes changed.
  [[nodiscard]] bool place(std::uint32_t volume, lattice_place& out) const noexcept;
  [[nodiscard]] bool volume_box(std::uint32_t volume, box& out) const noexcept;

  // The number of elements of room for places_differ.
  [[nodiscard]] std::size_t differ_room() const noexcept { return std::size_t{layout::volume_columns} * count_; }

  // Whether each volume has a position of its own. room: differ_room() numbers, overwritten. O(n log n).
  [[nodiscard]] bool places_differ(std::span<std::uint32_t> room) const noexcept;

 private:
  lattice_shape shape_;
  std::uint32_t count_ = 0;
  std::array<packed_column, layout::volume_columns> columns_;  // x, y, z
};

}  // namespace sightcell::format
