#include "cluster_table_writer.h"

#include <numeric>

#include "packed_columns_writer.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {

status check_clusters(const stored_order& order) {
  if (order.clusters.empty()) return status::ok;
  if (order.clusters.size() != order.orders.size()) return status::argument;
  for (std::size_t i = 0; i < order.orders.size(); ++i) {
    std::uint64_t polygons = 0;
    for (const std::uint32_t own : order.clusters[i]) {
      if (own == 0 || own > layout::max_cluster_polygons) return status::argument;
      polygons += own;
    }
    if (polygons != order.orders[i].size()) return status::argument;
  }
  return status::ok;
}

void put_clusters(const stored_order& order, std::vector<std::byte>& out) {
  std::vector<std::vector<std::uint32_t>> begins{{0}};
  std::vector<std::vector<std::uint32_t>> sizes{{}};
  for (const std::vector<std::uint32_t>& own : order.clusters) {
    begins[0].push_back(begins[0].back() + static_cast<std::uint32_t>(own.size()));
    sizes[0].insert(sizes[0].end(), own.begin(), own.end());
  }
  put_columns(begins, out);
  put_columns(sizes, out);
}

std::vector<std::uint32_t> cluster_begins(const stored_order& order, std::span<const std::uint32_t> unit_orders) {
  std::vector<std::uint32_t> begins;
  if (order.clusters.empty()) return begins;
  std::uint32_t next = 0;
  for (const std::uint32_t number : unit_orders) {
    for (const std::uint32_t own : order.clusters[number]) {
      begins.push_back(next);
      next += own;
    }
  }
  return begins;
}

}  // namespace sightcell::format
