#include "sightcell/format/volume_table.h"

#include <algorithm>
#include <array>
#include <memory>

#include "checked_reader.h"
#include "record_rules.h"
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
  if (!in.read_f64(0, made.shape_.width) || !in.read_f64(8, made.shape_.height) || !in.read_u32(16, made.count_)) {
    return status::corrupt;
  }
  if (made.count_ > layout::max_volumes || made.count_ > layout::max_polygons - polygons) return status::limit;
  if (!(made.shape_.width > 0.0) || !(made.shape_.height > 0.0)) return status::corrupt;  // an infinite one has no box
  // Positions differ, so each but a single one takes a bit: else few bytes could claim millions.
  if (made.count_ == 0 || made.count_ > 8 * bytes.size()) return status::corrupt;
  packed_columns columns;
  if (!columns.open(bytes.subspan(layout::volumes_head_size), layout::volume_columns, made.count_)) {
    return status::corrupt;
  }
  made.x_ = packed_column(columns, 0);
  made.y_ = packed_column(columns, 1);
  made.z_ = packed_column(columns, 2);
  lattice_place unused;
  for (std::uint32_t volume = 0; volume < made.count_; ++volume) {
    if (!made.place(volume, unused)) return status::corrupt;
  }
  out = made;
  return status::ok;
}

bool volume_table::place(std::uint32_t volume, lattice_place& out) const noexcept {
  if (volume >= count_) return false;
  const lattice_place found{to_signed(x_[volume]), to_signed(y_[volume]), to_signed(z_[volume]), 0};
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
  for (std::uint32_t volume = 0; volume < count_; ++volume) keys[volume] = {x_[volume], y_[volume], z_[volume]};
  std::make_heap(keys.begin(), keys.end());  // less code than std::sort, and fast enough
  std::sort_heap(keys.begin(), keys.end());
  return std::adjacent_find(keys.begin(), keys.end()) == keys.end();
}

}  // namespace sightcell::format
