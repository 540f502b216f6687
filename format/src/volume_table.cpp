#include "sightcell/format/volume_table.h"

#include <algorithm>
#include <array>
#include <memory>

#include "checked_reader.h"
#include "record_rules.h"
#include "shape_reader.h"
#include "sightcell/format/cell_lattice.h"

namespace sightcell::format {

bool is_volume_place(const lattice_shape& shape, const lattice_place& place) noexcept {
  constexpr std::int32_t most = 1 << 30;
  for (const std::int32_t at : {place.x, place.y, place.z}) {
    if (at < -most || at >= most) return false;
  }
  return place.level == 0 && box_is_valid(box_of(shape, place));
}

status volume_table::open(std::span<const std::byte> bytes, std::uint32_t polygons, volume_table& out) noexcept {
  volume_table made;
  const checked_reader in(bytes);
  if (!read_shape(in, made.shape_) || !in.read_u32(shape_size, made.count_)) return status::corrupt;
  if (made.count_ > layout::max_volumes || made.count_ > layout::max_polygons - polygons) return status::limit;
  // Positions differ, so each but a single one takes a bit: else few bytes could claim millions.
  if (made.count_ == 0 || made.count_ > 8 * bytes.size()) return status::corrupt;
  if (!open_columns(bytes.subspan(layout::volumes_head_size), made.count_, made.columns_)) return status::corrupt;
  lattice_place unused;
  for (std::uint32_t volume = 0; volume < made.count_; ++volume) {
    if (!made.place(volume, unused)) return status::corrupt;
  }
  out = made;
  return status::ok;
}

bool volume_table::place(std::uint32_t volume, lattice_place& out) const noexcept {
  if (volume >= count_) return false;
  const lattice_place found{to_signed(columns_[0][volume]), to_signed(columns_[1][volume]),
                            to_signed(columns_[2][volume]), 0};
  if (!is_volume_place(shape_, found)) return false;
  out = found;
  return true;
}

bool volume_table::volume_box(std::uint32_t volume, box& out) const noexcept {
  lattice_place found;
  if (!place(volume, found)) return false;
  out = box_of(shape_, found);
  return true;
}

// Sorts a copy: the bytes may change meanwhile.
bool volume_table::places_differ(std::span<std::uint32_t> room) const noexcept {
  using key = std::array<std::uint32_t, layout::volume_columns>;
  static_assert(sizeof(key) == layout::volume_columns * sizeof(std::uint32_t));
  if (room.size() < differ_room()) return false;
  auto* first = reinterpret_cast<key*>(room.data());
  std::uninitialized_default_construct_n(first, count_);
  const std::span<key> keys(first, count_);
  for (std::uint32_t volume = 0; volume < count_; ++volume) {
    for (std::size_t axis = 0; axis < 3; ++axis) keys[volume][axis] = columns_[axis][volume];
  }
  std::make_heap(keys.begin(), keys.end());  // less code than std::sort, and fast enough
  std::sort_heap(keys.begin(), keys.end());
  return std::adjacent_find(keys.begin(), keys.end()) == keys.end();
}

}  // namespace sightcell::format
