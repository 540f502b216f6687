#include "cluster_samples.h"

#include <algorithm>
#include <set>

#include "random_source.h"

namespace sightcell::test {

std::vector<std::uint32_t> cluster_of_source(const format::file_parts& parts) {
  std::vector<std::uint32_t> cluster(parts.facts.polygon_count);
  std::uint32_t clusters = 0;
  for (std::size_t first = 0, behind = 0; first < parts.draws.size(); first = behind) {
    std::vector<std::uint32_t> sources;
    const std::uint32_t order = parts.order_of_draw[first];
    const bool merged = parts.facts.layout == format::host_layout::merged;
    for (behind = first;
         behind < parts.draws.size() && (behind == first || (merged && parts.order_of_draw[behind] == order));
         ++behind) {
      const format::draw_record& d = parts.draws[behind];
      for (std::uint32_t i = 0; i < d.polygon_count; ++i) sources.push_back(d.first_source + i);
    }
    std::size_t at = 0;
    for (const std::uint32_t polygons : parts.clusters[order]) {
      for (std::uint32_t i = 0; i < polygons; ++i) cluster[sources[parts.orders[order][at++]]] = clusters;
      ++clusters;
    }
  }
  return cluster;
}

void put_in_clusters(sample_contents& contents, std::uint32_t seed, std::uint32_t most) {
  random_source random(seed);
  contents.clusters.clear();
  for (const auto& order : contents.orders) {
    std::vector<std::uint32_t>& sizes = contents.clusters.emplace_back();
    for (auto left = static_cast<std::uint32_t>(order.size()); left > 0; left -= sizes.back()) {
      sizes.push_back(std::min(left, 1 + random.below(most)));
    }
  }
  const std::vector<std::uint32_t> cluster = cluster_of_source(contents);
  for (std::vector<std::uint32_t>& set : contents.sets) {
    std::set<std::uint32_t> seen;
    std::vector<std::uint32_t> filled;
    for (const std::uint32_t item : set) {
      if (item < cluster.size()) seen.insert(cluster[item]);
    }
    for (std::uint32_t polygon = 0; polygon < cluster.size(); ++polygon) {
      if (seen.contains(cluster[polygon])) filled.push_back(polygon);
    }
    for (const std::uint32_t item : set) {
      if (item >= cluster.size()) filled.push_back(item);
    }
    set = std::move(filled);
  }
}

}  // namespace sightcell::test
