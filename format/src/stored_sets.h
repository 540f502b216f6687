#pragma once
// Converts sets of source ids, and of volumes after them, to runs in the order that a file stores: of polygons, or of
// clusters, which are in a set if any of their polygons is.
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::format {

class stored_sets {
 public:
  // draws: in stored order, without gaps by first_stored; their source ids are all below the number of polygons, each
  //   once.
  // order_of_draw: the order of each draw.
  // orders: permutations, each of the length of its draws, or of its draw group.
  // volumes: their number.
  // cluster_begins: stored number of the first polygon of each cluster, ascending; empty without clusters.
  // The arguments are not kept.
  stored_sets(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw,
              std::span<const std::vector<std::uint32_t>> orders, host_layout layout = host_layout::instanced,
              std::uint32_t volumes = 0, std::span<const std::uint32_t> cluster_begins = {});

  // The numbers in sets below those of volumes: polygons, or clusters.
  [[nodiscard]] std::uint32_t columns() const { return columns_; }

  // Computes the stored polygons of a set of source ids, each once, in any order. The numbers of volumes, which follow
  // those of polygons, stay. runs is replaced.
  // members: bits that are reused from call to call; each thread has its own.
  void runs_of(std::span<const std::uint32_t> source_ids, std::vector<std::uint64_t>& members,
               std::vector<run>& runs) const;

 private:
  std::uint32_t columns_ = 0, volumes_ = 0;
  std::vector<std::uint32_t> stored_of_source_;  // or the number of its cluster
};

}  // namespace sightcell::format
