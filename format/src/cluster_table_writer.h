#pragma once
// Writes the clusters section. The counterpart for reading, cluster_table.h, describes it.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/status.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// argument: a cluster has no polygon, or more than max_cluster_polygons, or the clusters of an order do not have its
// polygons.
status check_clusters(const stored_order& order);

// Appends the section. order: checked, with clusters.
void put_clusters(const stored_order& order, std::vector<std::byte>& out);

// Where the clusters of all range units begin, in stored polygons, in ascending order; empty without clusters.
// unit_orders: the order of each unit.
std::vector<std::uint32_t> cluster_begins(const stored_order& order, std::span<const std::uint32_t> unit_orders);

}  // namespace sightcell::format
