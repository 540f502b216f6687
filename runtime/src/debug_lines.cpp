#include "debug_lines.h"

#include <algorithm>
#include <array>

namespace sightcell::runtime {
namespace {

constexpr std::size_t most_neighbors = 64;
constexpr std::size_t edges = 12;

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

// Counts boxes, and writes the lines of each as far as there is room for them.
class line_sink {
 public:
  line_sink(const point& origin, std::span<sightcell_debug_line> dst) : origin_(origin), left_(dst) {}

  void add(const wide_box& b, std::uint32_t kind, std::uint32_t number) noexcept;
  std::uint64_t boxes() const noexcept { return boxes_; }

 private:
  const point& origin_;
  std::span<sightcell_debug_line> left_;
  std::uint64_t boxes_ = 0;
};

void line_sink::add(const wide_box& b, std::uint32_t kind, std::uint32_t number) noexcept {
  ++boxes_;
  if (left_.size() < edges) return;
  for (std::size_t edge = 0; edge < edges; ++edge) {
    sightcell_debug_line& line = left_[edge];
    line = edge_of(b, origin_, edge);
    line.kind = kind;
    line.number = number;
  }
  left_ = left_.subspan(edges);
}

// Adds the parts of the grown box of the cell that are outside its region.
sightcell_status add_parts_outside(const sightcell_view& view, line_sink& lines) {
  const format::reader& file = view.db().file();
  if (!file.viewpoints().exists()) return SIGHTCELL_OK;
  const format::box grown = format::grown_box(view.cell_bounds(), file.facts().margin);
  return static_cast<sightcell_status>(
      file.viewpoints().parts(view.cell(), grown, [&](const format::region_part& part) {
        if (!part.inside) lines.add(widened(part.bounds), SIGHTCELL_DEBUG_OUTSIDE_REGION, view.cell());
      }));
}

// Adds all boxes of these kinds. CORRUPT: the region of the cell is damaged.
sightcell_status add_boxes(const sightcell_view& view, std::uint32_t kinds, line_sink& lines) {
  const sightcell_db& db = view.db();
  const std::uint32_t cell = view.cell();
  if (cell != no_cell) {
    const wide_box kept = widened(view.cell_bounds(), db.file().facts().margin);
    if ((kinds & SIGHTCELL_DEBUG_CELL) != 0) lines.add(widened(view.cell_bounds()), SIGHTCELL_DEBUG_CELL, cell);
    if ((kinds & SIGHTCELL_DEBUG_KEPT) != 0) lines.add(kept, SIGHTCELL_DEBUG_KEPT, cell);
    if ((kinds & SIGHTCELL_DEBUG_NEIGHBORS) != 0) {
      std::array<located_cell, most_neighbors + 1> near;  // one more, for the cell itself
      const std::size_t count = std::min(db.locator().touching(kept, near), near.size());
      sort_by_number({near.data(), count});
      std::size_t left = most_neighbors;  // touching may not return the cell itself
      for (std::size_t i = 0; i < count; ++i) {
        if (near[i].cell == cell || left == 0) continue;
        lines.add(widened(near[i].bounds), SIGHTCELL_DEBUG_NEIGHBORS, near[i].cell);
        --left;
      }
    }
    if ((kinds & SIGHTCELL_DEBUG_OUTSIDE_REGION) != 0) {
      if (const sightcell_status s = add_parts_outside(view, lines); s != SIGHTCELL_OK) return s;
    }
  }
  if ((kinds & SIGHTCELL_DEBUG_VOLUMES) == 0) return SIGHTCELL_OK;
  const format::volume_table& volumes = db.file().volumes();
  format::box bounds;
  for (std::uint32_t v = 0; v < volumes.count(); ++v) {
    if (view.volume_visible(v) && volumes.volume_box(v, bounds)) lines.add(widened(bounds), SIGHTCELL_DEBUG_VOLUMES, v);
  }
  return SIGHTCELL_OK;
}

}  // namespace

sightcell_status count_debug_lines(const sightcell_view& view, std::uint32_t kinds, std::uint64_t& count) noexcept {
  line_sink none(view.origin(), {});
  const sightcell_status s = add_boxes(view, kinds, none);
  if (s == SIGHTCELL_OK) count = edges * none.boxes();
  return s;
}

// The bytes of the file may have changed since the lines were counted, so that there are more or fewer now.
sightcell_status write_debug_lines(const sightcell_view& view, std::uint32_t kinds,
                                   std::span<sightcell_debug_line> dst) noexcept {
  line_sink lines(view.origin(), dst);
  const sightcell_status s = add_boxes(view, kinds, lines);
  return s == SIGHTCELL_OK && edges * lines.boxes() == dst.size() ? SIGHTCELL_OK : SIGHTCELL_ERR_CORRUPT;
}

}  // namespace sightcell::runtime
