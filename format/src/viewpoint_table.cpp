#include "sightcell/format/viewpoint_table.h"

#include <bit>

#include "checked_reader.h"
#include "record_rules.h"

namespace sightcell::format {
namespace {

// The two bits of a node.
constexpr std::uint32_t leaf_outside = 0;
constexpr std::uint32_t leaf_inside = 1;
constexpr std::uint32_t split_node = 2;
constexpr std::uint64_t nodes_per_byte = 4;

// Of equal sides the first one.
std::size_t longest_side(const box& b) noexcept {
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (b.max[axis] - b.min[axis] > b.max[longest] - b.min[longest]) longest = axis;
  }
  return longest;
}

}  // namespace

box grown_box(const box& cell, float margin) noexcept {
  box grown;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grown.min[axis] = cell.min[axis] - margin;
    grown.max[axis] = cell.max[axis] + margin;
  }
  return grown;
}

region_walk::region_walk(std::span<const std::byte> bytes, const box& grown) noexcept
    : bytes_(bytes), waiting_count_(1) {
  waiting_[0].bounds = grown;
  if (bytes.size() > layout::max_region_size) stop(status::limit);
}

bool region_walk::next(region_part& out) noexcept {
  if (waiting_count_ == 0) return false;
  if (bytes_.empty()) {  // the whole box
    out = {waiting_[0].bounds, true};
    waiting_count_ = 0;
    return true;
  }
  while (true) {
    const node here = waiting_[--waiting_count_];
    std::uint32_t kind = 0;
    if (!read_kind(kind) || kind > split_node || (here.depth == 0 && kind != split_node)) return stop(status::corrupt);
    if (kind == split_node) {
      if (!split(here)) return stop(status::corrupt);
      continue;
    }
    any_inside_ = any_inside_ || kind == leaf_inside;
    // A fault at the end is found before the last part is returned.
    if (waiting_count_ == 0 && !ends_well()) return stop(status::corrupt);
    out = {here.bounds, kind != leaf_outside};
    return true;
  }
}

bool region_walk::read_kind(std::uint32_t& out) noexcept {
  std::uint8_t byte = 0;
  if (!checked_reader(bytes_).read_u8(nodes_ / nodes_per_byte, byte)) return false;
  out = byte >> 2 * (nodes_ % nodes_per_byte) & 3u;
  ++nodes_;
  return true;
}

// The children of a split wait in place of it: the lower one is the next.
bool region_walk::split(const node& parent) noexcept {
  if (parent.depth == layout::max_region_depth) return false;
  const std::size_t axis = longest_side(parent.bounds);
  const float middle = 0.5f * (parent.bounds.min[axis] + parent.bounds.max[axis]);
  if (!(parent.bounds.min[axis] < middle && middle < parent.bounds.max[axis])) return false;
  node lower{parent.bounds, parent.depth + 1};
  node upper = lower;
  lower.bounds.max[axis] = middle;
  upper.bounds.min[axis] = middle;
  waiting_[waiting_count_++] = upper;
  waiting_[waiting_count_++] = lower;
  return true;
}

// Tests that the byte of the last node is the last one, without more bits.
bool region_walk::ends_well() const noexcept {
  std::uint8_t last = 0;
  if (!any_inside_ || (nodes_ + nodes_per_byte - 1) / nodes_per_byte != bytes_.size()) return false;
  if (!checked_reader(bytes_).read_u8(bytes_.size() - 1, last)) return false;
  const std::uint64_t used = (nodes_ - 1) % nodes_per_byte + 1;
  return last >> 2 * used == 0;
}

bool region_walk::stop(status result) noexcept {
  waiting_count_ = 0;
  result_ = result;
  return false;
}

status viewpoint_table::open(std::span<const std::byte> bytes, std::uint32_t cells, viewpoint_table& out) noexcept {
  viewpoint_table made;
  if (!checked_reader(bytes).read_f32(0, made.player_radius_) || !is_player_radius(made.player_radius_)) {
    return status::corrupt;
  }
  const std::span<const std::byte> left = bytes.subspan(layout::viewpoints_head_size);
  packed_columns columns;
  std::uint64_t size = 0;
  if (!packed_columns::size_of(left, layout::viewpoint_columns, cells, size) ||
      !columns.open(left.first(static_cast<std::size_t>(size)), layout::viewpoint_columns, cells)) {
    return status::corrupt;
  }
  made.valid_ = packed_column(columns, 0);
  made.outside_ = packed_column(columns, 1);
  made.region_ends_ = packed_column(columns, 2);
  made.regions_ = left.subspan(static_cast<std::size_t>(size));
  made.cells_ = cells;
  std::uint32_t end = 0;
  for (std::uint32_t cell = 0; cell < cells; ++cell) {
    const std::uint32_t begin = end;
    end = made.region_ends_[cell];
    if (end < begin) return status::corrupt;
    if (end - begin > layout::max_region_size) return status::limit;
    if (!viewpoint_shares_are_valid(made.valid_share(cell), static_cast<double>(made.outside_share(cell)),
                                    end == begin)) {
      return status::corrupt;
    }
  }
  if (end != made.regions_.size()) return status::corrupt;
  out = made;
  return status::ok;
}

float viewpoint_table::valid_share(std::uint32_t cell) const noexcept {
  return exists() ? std::bit_cast<float>(valid_[cell]) : 1.0f;
}

float viewpoint_table::outside_share(std::uint32_t cell) const noexcept {
  return exists() ? std::bit_cast<float>(outside_[cell]) : 0.0f;
}

std::span<const std::byte> viewpoint_table::region_bytes(std::uint32_t cell) const noexcept {
  std::span<const std::byte> bytes;
  return find(cell, bytes) == status::ok ? bytes : std::span<const std::byte>();
}

status viewpoint_table::walk_parts(std::uint32_t cell, const box& grown,
                                   void (*take)(const void* caller, const region_part& part),
                                   const void* caller) const noexcept {
  std::span<const std::byte> bytes;
  if (const status s = find(cell, bytes); s != status::ok) return s;
  region_walk walk(bytes, grown);
  for (region_part part; walk.next(part);) take(caller, part);
  return walk.result();
}

status viewpoint_table::find(std::uint32_t cell, std::span<const std::byte>& out) const noexcept {
  if (cell >= cells_) return status::argument;
  const std::uint32_t begin = cell == 0 ? 0 : region_ends_[cell - 1];
  const std::uint32_t end = region_ends_[cell];
  if (begin > end || end > regions_.size()) return status::corrupt;
  out = regions_.subspan(begin, end - begin);
  return status::ok;
}

}  // namespace sightcell::format
