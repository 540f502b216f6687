#pragma once
// The clusters that the sets of a file consist of (--granularity cluster), for converting runs of polygons.
#include <cstddef>
#include <cstdint>
#include <span>

#include "db.h"
#include "memory.h"

namespace sightcell::runtime {

class file_clusters {
 public:
  // Sets the sizes of the tables for a file, for carve(). No tables for a file without clusters.
  void measure(const sightcell_db& db) noexcept;
  void carve(carver& space) noexcept;
  // Fills the tables. The clusters of an open db were checked when it was opened.
  void fill(const sightcell_db& db) noexcept;

  [[nodiscard]] bool exist() const noexcept { return begins_.size() > 1; }
  [[nodiscard]] std::uint32_t count() const noexcept { return static_cast<std::uint32_t>(begins_.size() - 1); }
  // Stored number of the first polygon of a cluster, or the number of polygons for count().
  [[nodiscard]] std::uint32_t begin(std::uint32_t cluster) const noexcept { return begins_[cluster]; }
  // The cluster that has a stored polygon; count() for the number of polygons.
  [[nodiscard]] std::uint32_t at(std::uint32_t polygon) const noexcept {
    std::uint32_t cluster = of_block_[polygon / block];
    while (cluster < count() && begins_[cluster + 1] <= polygon) ++cluster;
    return cluster;
  }

 private:
  static constexpr std::uint32_t block = 64;  // polygons

  std::span<std::uint32_t> begins_;    // then the number of polygons
  std::span<std::uint32_t> of_block_;  // the cluster of the first polygon of each block
};

// Sets the bits first .. end - 1 of a row.
void set_bits(std::span<std::uint32_t> row, std::uint32_t first, std::uint32_t end) noexcept;

// Writes the clusters of a file as ranges, in the order of their numbers. dst: one for each.
void list_file_clusters(const sightcell_db& db, sightcell_range* dst) noexcept;

}  // namespace sightcell::runtime
