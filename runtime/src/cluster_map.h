#pragma once
// The host's clusters of polygons in the order of a file, and the bits that a set of polygons has in them.
#include <cstddef>
#include <cstdint>
#include <span>

#include "cluster_windows.h"
#include "db.h"
#include "file_clusters.h"
#include "memory.h"
#include "sightcell/clusters.h"

namespace sightcell::runtime {

// The bits that some polygons have in one word of the row.
struct cluster_bits {
  std::uint32_t word = 0;
  std::uint32_t bits = 0;
};

// The stored polygons in blocks of equal size. The bits of block b are begins[b] .. begins[b + 1] - 1, so those of
// consecutive blocks are one list.
struct cluster_blocks {
  std::span<std::uint32_t> begins;
  std::span<cluster_bits> bits;
};

// Writes the clusters of a row in ascending order, up to dst.size(). Returns their number.
std::uint64_t list_clusters(std::span<const std::uint32_t> row, std::span<std::uint32_t> dst) noexcept;

// Writes the words in which two rows of equal size differ, up to dst.size(). Returns their number.
std::uint64_t list_changes(std::span<const std::uint32_t> before, std::span<const std::uint32_t> now,
                           std::span<sightcell_cluster_word> dst) noexcept;

}  // namespace sightcell::runtime

// In the global namespace, because the C API declares it.
struct sightcell_cluster_map {
 public:
  // db: open. cluster_of_source: one element per polygon of db.
  static sightcell_status create(const sightcell_db& db, std::span<const std::uint32_t> cluster_of_source,
                                 std::uint32_t cluster_count, sightcell_cluster_map** out) noexcept;
  // The clusters of the file itself, which must have some.
  static sightcell_status create_of_file(const sightcell_db& db, sightcell_cluster_map** out) noexcept;
  static void destroy(sightcell_cluster_map* map) noexcept;

  [[nodiscard]] const sightcell_db& db() const noexcept { return *db_; }
  // The number of words of a row.
  [[nodiscard]] std::size_t words() const noexcept { return words_; }
  // Sets the bits of the clusters of a set. set: runs of stored polygons. row: words() elements or more.
  void mark(std::span<const sightcell::format::run> set, std::span<std::uint32_t> row) const noexcept;

 private:
  sightcell_cluster_map() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  static sightcell_status make(const sightcell_cluster_map& plan, sightcell_cluster_map** out) noexcept;
  [[nodiscard]] bool take_file_clusters(std::span<const std::uint32_t> cluster_of_source) noexcept;
  void mark_file_clusters(std::span<const sightcell::format::run> set, std::span<std::uint32_t> row) const noexcept;
  void fill(std::span<const std::uint32_t> cluster_of_source) noexcept;

  const sightcell_db* db_ = nullptr;
  std::uint64_t block_size_ = 0;
  std::size_t words_ = 0;
  // For a file of clusters, unless polygons of one of these are in different clusters of the host: these, and the bit
  // of each in the row, or nothing if they are the clusters of the row. Then the tables below are empty.
  sightcell::runtime::file_clusters of_file_;
  std::span<std::uint32_t> host_of_file_;
  std::span<sightcell::runtime::cluster_window> windows_;
  std::span<std::uint16_t> cluster_of_stored_;  // in its window
  // Of 16 and of 128 polygons; polygons after the last whole block are in none.
  sightcell::runtime::cluster_blocks small_, large_;
};
