#include "sightcell/format/cluster_table.h"

#include "sightcell/format/layout.h"

namespace sightcell::format {

status cluster_table::open(std::span<const std::byte> bytes, const packed_column& order_begins, std::uint32_t orders,
                           cluster_table& out) noexcept {
  cluster_table made;
  packed_columns columns;
  std::uint64_t size = 0;
  if (!packed_columns::size_of(bytes, 1, orders + 1, size)) return status::corrupt;
  if (!columns.open(bytes.first(static_cast<std::size_t>(size)), 1, orders + 1)) return status::corrupt;
  made.first_cluster_ = packed_column(columns, 0);
  const std::uint32_t clusters = made.first_cluster_[orders];
  // Each has a polygon, and each polygon of an order has taken bits: few bytes cannot claim many clusters.
  if (made.first_cluster_[0] != 0 || clusters > order_begins[orders]) return status::corrupt;
  packed_columns sizes;
  if (!sizes.open(bytes.subspan(static_cast<std::size_t>(size)), 1, clusters)) return status::corrupt;
  made.polygons_ = packed_column(sizes, 0);
  for (std::uint32_t order = 0; order < orders; ++order) {
    const std::uint32_t end = made.first_cluster_[order + 1];
    if (end < made.first_cluster_[order] || end > clusters) return status::corrupt;
    std::uint64_t polygons = 0;
    for (std::uint32_t i = made.first_cluster_[order]; i < end; ++i) {
      const std::uint32_t own = made.polygons_[i];
      if (own == 0 || own > layout::max_cluster_polygons) return status::corrupt;
      polygons += own;
    }
    if (polygons != order_begins[order + 1] - order_begins[order]) return status::corrupt;
  }
  made.exists_ = true;
  made.orders_ = orders;
  out = made;
  return status::ok;
}

// Borders ascend, so each is searched for from the unit of the one before.
void cluster_borders::expand(std::span<run> runs) const noexcept {
  const std::uint32_t clusters = count();
  const std::uint32_t polygons = unit_polygons_.back();
  std::uint32_t unit = 0;
  const auto polygon_of = [&](std::uint32_t cluster) {
    if (cluster >= clusters) return polygons + (cluster - clusters);
    while (unit_clusters_[unit + 1] <= cluster) ++unit;
    return unit_polygons_[unit] + begins_[unit_begins_of_[unit] + (cluster - unit_clusters_[unit])];
  };
  for (run& r : runs) {
    const std::uint32_t begin = polygon_of(r.first);
    const std::uint32_t end = polygon_of(r.first + r.count);
    r = {begin, end - begin};
  }
}

}  // namespace sightcell::format
