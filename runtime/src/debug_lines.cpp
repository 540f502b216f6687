#include "debug_lines.h"

#include <algorithm>
#include <array>

namespace sightcell::runtime {
namespace {

constexpr std::size_t most_neighbors = 64;

// Calls emit(box, kind, number) for each box.
template <class Emit>
void for_each_box(const sightcell_view& view, std::uint32_t kinds, const Emit& emit) {
  const sightcell_db& db = view.db();
  const std::uint32_t cell = view.cell();
  if (cell != no_cell) {
    const wide_box kept = widened(view.cell_bounds(), db.file().facts().margin);
    if ((kinds & SIGHTCELL_DEBUG_CELL) != 0) emit(widened(view.cell_bounds()), SIGHTCELL_DEBUG_CELL, cell);
    if ((kinds & SIGHTCELL_DEBUG_KEPT) != 0) emit(kept, SIGHTCELL_DEBUG_KEPT, cell);
    if ((kinds & SIGHTCELL_DEBUG_NEIGHBORS) != 0) {
      std::array<located_cell, most_neighbors + 1> near;  // one more, for the cell itself
      const std::size_t count = std::min(db.locator().touching(kept, near), near.size());
      sort_by_number({near.data(), count});
      std::size_t left = most_neighbors;  // touching may not return the cell itself
      for (std::size_t i = 0; i < count; ++i) {
        if (near[i].cell == cell || left == 0) continue;
        emit(widened(near[i].bounds), SIGHTCELL_DEBUG_NEIGHBORS, near[i].cell);
        --left;
      }
    }
  }
  if ((kinds & SIGHTCELL_DEBUG_VOLUMES) == 0) return;
  const format::volume_table& volumes = db.file().volumes();
  format::box bounds;
  for (std::uint32_t v = 0; v < volumes.count(); ++v) {
    if (view.volume_visible(v) && volumes.volume_box(v, bounds)) emit(widened(bounds), SIGHTCELL_DEBUG_VOLUMES, v);
  }
}

// Edge e is parallel to axis e / 4; its two lowest bits select the ends of the other two axes.
sightcell_debug_line edge_of(const wide_box& b, const point& origin, std::size_t edge) noexcept {
  sightcell_debug_line line{};
  const std::size_t along = edge / 4;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t bit = axis == (along + 1) % 3 ? 1 : 2;
    const bool high = axis != along && (edge & bit) != 0;
    line.from[axis] = static_cast<float>((high ? b.max[axis] : b.min[axis]) - origin[axis]);
    line.to[axis] = axis == along ? static_cast<float>(b.max[axis] - origin[axis]) : line.from[axis];
  }
  return line;
}

// Counts the lines, and writes them unless dst is null.
std::uint64_t list_lines(const sightcell_view& view, std::uint32_t kinds, sightcell_debug_line* dst) noexcept {
  std::uint64_t boxes = 0;
  for_each_box(view, kinds, [&](const wide_box& b, std::uint32_t kind, std::uint32_t number) {
    ++boxes;
    for (std::size_t edge = 0; edge < 12 && dst != nullptr; ++edge) {
      *dst = edge_of(b, view.origin(), edge);
      dst->kind = kind;
      (dst++)->number = number;
    }
  });
  return 12 * boxes;
}

}  // namespace

std::uint64_t count_debug_lines(const sightcell_view& view, std::uint32_t kinds) noexcept {
  return list_lines(view, kinds, nullptr);
}

void write_debug_lines(const sightcell_view& view, std::uint32_t kinds, sightcell_debug_line* dst) noexcept {
  static_cast<void>(list_lines(view, kinds, dst));
}

}  // namespace sightcell::runtime
