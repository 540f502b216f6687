#include "file_clusters.h"

#include <algorithm>

namespace sightcell::runtime {
namespace {

constexpr std::uint32_t bits_per_row_word = 32;

// Calls take(unit, first, count), in polygons of the draw or draw group, for each cluster.
template <class Take>
void for_each_file_cluster(const sightcell_db& db, const Take& take) noexcept {
  const format::cluster_borders& borders = format::reader::borders_of_clusters(*db.codes());
  for (std::uint32_t unit = 0; unit < borders.unit_count(); ++unit) {
    const std::span<const std::uint32_t> begins = borders.begins_in(unit);
    for (std::size_t i = 0; i + 1 < begins.size(); ++i) take(unit, begins[i], begins[i + 1] - begins[i]);
  }
}

}  // namespace

void file_clusters::measure(const sightcell_db& db) noexcept {
  const std::size_t clusters = db.file().cluster_count();
  if (clusters == 0) return;
  begins_ = {static_cast<std::uint32_t*>(nullptr), clusters + 1};
  of_block_ = {static_cast<std::uint32_t*>(nullptr), std::size_t{db.polygon_count()} / block + 1};
}

void file_clusters::carve(carver& space) noexcept {
  for (std::span<std::uint32_t>* table : {&begins_, &of_block_}) {
    std::uint32_t* first = space.take<std::uint32_t>(table->size());
    if (first == nullptr) continue;
    construct(first, table->size());
    *table = {first, table->size()};
  }
}

void file_clusters::fill(const sightcell_db& db) noexcept {
  if (!exist()) return;
  std::uint32_t cluster = 0;
  std::uint32_t stored = 0;
  std::uint32_t next_block = 0;
  for_each_file_cluster(db, [&](std::uint32_t, std::uint32_t, std::uint32_t count) {
    begins_[cluster] = stored;
    stored += count;
    for (; next_block < of_block_.size() && std::uint64_t{next_block} * block < stored; ++next_block)
      of_block_[next_block] = cluster;
    ++cluster;
  });
  begins_[cluster] = stored;
  for (; next_block < of_block_.size(); ++next_block) of_block_[next_block] = cluster;
}

void set_bits(std::span<std::uint32_t> row, std::uint32_t first, std::uint32_t end) noexcept {
  if (first >= end) return;
  const std::uint32_t first_word = first / bits_per_row_word;
  const std::uint32_t last_word = (end - 1) / bits_per_row_word;
  const std::uint32_t from = ~0u << first % bits_per_row_word;
  const std::uint32_t to = ~0u >> (bits_per_row_word - 1 - (end - 1) % bits_per_row_word);
  if (first_word == last_word) {
    row[first_word] |= from & to;
    return;
  }
  row[first_word] |= from;
  std::fill(row.begin() + first_word + 1, row.begin() + last_word, ~0u);
  row[last_word] |= to;
}

void list_file_clusters(const sightcell_db& db, sightcell_range* dst) noexcept {
  for_each_file_cluster(db, [&](std::uint32_t unit, std::uint32_t first, std::uint32_t count) {
    *dst++ = {unit, first, count};
  });
}

}  // namespace sightcell::runtime
