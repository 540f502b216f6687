#pragma once
// Clusters of contents of .pvs files for tests.
#include <cstdint>
#include <vector>

#include "unit/format/sample_contents.h"

namespace sightcell::test {

// The number of the cluster of every polygon, by source id: clusters are counted through all draws in stored order.
std::vector<std::uint32_t> cluster_of_source(const format::file_parts& parts);

// Divides the orders of some contents into clusters of 1 to `most` polygons, and fills the clusters in all sets.
void put_in_clusters(sample_contents& contents, std::uint32_t seed, std::uint32_t most);

}  // namespace sightcell::test
