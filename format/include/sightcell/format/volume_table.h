#pragma once
// Volumes (SPEC.md, "Volumes"): boxes on a lattice that cells see or do not see, as they do polygons, though nobody
// draws them. volume_table_writer.h is the way back.
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightcell/format/layout.h"
#include "sightcell/format/packed_columns.h"
#include "sightcell/format/records.h"
#include "sightcell/format/status.h"

namespace sightcell::format {

// Whether a volume may lie at a place: its coordinates are those of cells of level 0, and the box is one.
[[nodiscard]] bool is_volume_place(const lattice_shape& shape, const lattice_place& place) noexcept;

class volume_table {
 public:
  // A table without volumes.
  volume_table() noexcept = default;
  // bytes: the section and nothing behind it; viewed. polygons: of the file. limit: more volumes than a file can have;
  // corrupt: none at all, no lattice, a place where no volume can be. That no two lie at the same place is left to
  // places_differ(). out is set only on ok. O(volumes).
  static status open(std::span<const std::byte> bytes, std::uint32_t polygons, volume_table& out) noexcept;

  [[nodiscard]] std::uint32_t count() const noexcept { return count_; }
  // Of a place, in metres.
  [[nodiscard]] const lattice_shape& shape() const noexcept { return shape_; }

  // Where a volume lies, on level 0, or its box; read and checked anew. False when there is no such volume, or somebody
  // changed the bytes.
  [[nodiscard]] bool place(std::uint32_t volume, lattice_place& out) const noexcept;
  [[nodiscard]] bool volume_box(std::uint32_t volume, box& out) const noexcept;

  // Numbers of room that this needs.
  [[nodiscard]] std::size_t differ_room() const noexcept { return std::size_t{layout::volume_columns} * count_; }
  // Whether each volume has a place of its own. room: differ_room() numbers, overwritten. O(n log n).
  [[nodiscard]] bool places_differ(std::span<std::uint32_t> room) const noexcept;

 private:
  lattice_shape shape_;
  std::uint32_t count_ = 0;
  packed_column x_, y_, z_;
};

}  // namespace sightcell::format
