#pragma once
// One open file and what is derived from it at open: the cell locator, the borders of ranges, and which chunks of
// rows have been checked or are in memory. Shared by threads; only the states of chunks change after open.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cell_locator.h"
#include "chunk_cache.h"
#include "memory.h"
#include "sightcell/format/reader.h"
#include "volume_index.h"

namespace sightcell::runtime {

// Of a file that lies in memory.
enum class chunk_state : std::uint8_t { unknown, good, damaged };

// What became of decoding a row.
enum class row_outcome : std::uint8_t { good, damaged, pending };

// Where the polygons of a draw, or draw group of a merged file, come from.
struct range_source {
  std::uint32_t first_source = 0;
  std::uint32_t order_begin = 0;  // place of its order among all orders
  std::uint32_t base_vertex = 0;  // vertices of all draws before it; 0 for draw groups
};

}  // namespace sightcell::runtime

// In the global namespace since the C API names it.
struct sightcell_db {
 public:
  // bytes: viewed. owned_bytes: a block of mem that holds them and goes with the db, or null.
  static sightcell_status open(std::span<const std::byte> bytes, const sightcell_allocator& mem, void* owned_bytes,
                               sightcell_db** out) noexcept;
  // out is set at once, for deliver, and null again on failure.
  static sightcell_status open_source(const sightcell_source& source, const sightcell_allocator& mem,
                                      std::uint64_t resident_bytes, sightcell_db** out) noexcept;
  static void close(sightcell_db* db) noexcept;

  [[nodiscard]] const sightcell::format::reader& file() const noexcept { return file_; }
  [[nodiscard]] const sightcell_allocator& allocator() const noexcept { return mem_; }
  [[nodiscard]] const sightcell::runtime::cell_locator& locator() const noexcept { return locator_; }
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return file_.polygon_count(); }

  // Stored number of the first polygon of each draw, or draw group of a merged file, ascending, then polygon_count. A
  // checked copy: the file's bytes may change.
  [[nodiscard]] std::span<const std::uint32_t> range_borders() const noexcept { return range_borders_; }
  // Of a draw, or draw group of a merged file; format::no_named_group for most.
  [[nodiscard]] std::uint32_t named_group_of(std::uint32_t draw) const noexcept {
    return named_groups_.empty() ? sightcell::format::no_named_group : named_groups_[draw];
  }
  // Of these, how many are in one: the most stretches of stored polygons that named groups are.
  [[nodiscard]] std::uint32_t named_range_count() const noexcept { return named_ranges_; }
  // The most ranges any answer has, everything included.
  [[nodiscard]] std::uint32_t range_bound() const noexcept;

  // The code tables of the file; null in version 0.
  [[nodiscard]] const sightcell::format::row_codes* codes() const noexcept { return codes_; }
  // The polygons of a range, as numbers that first_source of its draw, or draw group, is to be added to.
  [[nodiscard]] std::span<const std::uint32_t> sources_in(std::uint32_t draw, std::uint32_t first,
                                                          std::uint32_t count) const noexcept {
    return orders_.subspan(range_sources_[draw].order_begin + first, count);
  }
  // 0 for draw groups, whose polygons do not follow each other in the source.
  [[nodiscard]] std::uint32_t first_source(std::uint32_t draw) const noexcept {
    return range_sources_[draw].first_source;
  }

  [[nodiscard]] std::uint32_t base_vertex(std::uint32_t draw) const noexcept {
    return range_sources_[draw].base_vertex;
  }
  [[nodiscard]] bool is_merged() const noexcept;
  // Of a merged file: the draw that a polygon of a draw group belongs to. near: where to look first, and the answer.
  void find_draw(std::uint32_t group, std::uint32_t source, std::uint32_t& near) const noexcept;
  // The draws of a draw group, which lie one behind the other: first, and behind the last.
  [[nodiscard]] std::uint32_t draws_begin(std::uint32_t group) const noexcept { return group_draws_[group]; }

  // The set of a cell. Checks its chunk at the first use and remembers the answer; asks for it where it is not in
  // memory. out, scratch, parts: as reader::decode_row has them. Damaged: or not what a row may be.
  [[nodiscard]] sightcell::runtime::row_outcome decode(std::uint32_t cell, std::span<sightcell::format::run> out,
                                                       std::span<std::byte> scratch,
                                                       sightcell::format::row_parts& parts) const noexcept;
  // Of the volumes of the file; without any where there are none.
  [[nodiscard]] const sightcell::runtime::volume_index& volumes() const noexcept { return volumes_; }

  [[nodiscard]] bool is_paged() const noexcept { return source_.request != nullptr; }
  // Only where paged.
  [[nodiscard]] sightcell::runtime::chunk_cache& cache() const noexcept { return cache_; }
  sightcell_status deliver(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept;

  [[nodiscard]] sightcell_status check() const noexcept;
  // Of the allocator, for as long as the db is open.
  [[nodiscard]] std::uint64_t memory_bytes() const noexcept {
    return block_size_ + tables_size_ + (owned_bytes_ == nullptr ? 0 : owned_size_);
  }

 private:
  // Bytes that open_source waits for.
  struct opening_request {
    std::span<std::byte> target;
    std::uint32_t ticket = 0;
    bool waits = false;
  };

  sightcell_db() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] sightcell_status fill() noexcept;
  [[nodiscard]] bool fill_ranges() noexcept;
  [[nodiscard]] bool fill_draws_of_groups() noexcept;
  [[nodiscard]] bool fill_named_groups() noexcept;
  [[nodiscard]] bool cell_is_sound(std::uint32_t cell) const noexcept;
  [[nodiscard]] sightcell_status open_pages(std::uint64_t resident_bytes) noexcept;
  [[nodiscard]] sightcell_status fetch(std::span<std::byte> target) noexcept;

  sightcell::format::reader file_;
  sightcell_allocator mem_{};
  sightcell::runtime::cell_locator locator_;
  sightcell::runtime::locator_memory cells_;
  sightcell::runtime::volume_index volumes_;
  std::span<std::uint32_t> range_borders_;
  std::span<sightcell::runtime::range_source> range_sources_;
  // All orders, one behind the other, which instances share; of a merged file, where nothing does, source ids.
  std::span<std::uint32_t> orders_;
  // Of a merged file: first draw of each group, then the draw count; source id of each draw's first polygon.
  std::span<std::uint32_t> group_draws_, draw_sources_;
  // By draw, or draw group; empty where the file has no named groups.
  std::span<std::uint32_t> named_groups_;
  std::span<std::byte> codes_memory_;
  const sightcell::format::row_codes* codes_ = nullptr;
  // Threads may check the same chunk at once and write the same answer: no lock needed. Of a file that lies in memory.
  std::span<std::atomic<sightcell::runtime::chunk_state>> chunks_;
  std::uint32_t whole_ranges_ = 0;  // draws, or draw groups, that have polygons: the ranges of everything
  std::uint32_t named_ranges_ = 0;
  // Of a file that is read piece by piece.
  sightcell_source source_{};
  opening_request opening_;
  mutable sightcell::runtime::chunk_cache cache_;
  std::span<sightcell::runtime::cached_chunk> cached_;
  std::span<std::uint32_t> cached_order_;
  std::span<std::byte> room_;
  // What goes with the db: itself with its tables, or, of a file that is read piece by piece, the tables apart.
  std::uint64_t block_size_ = 0;
  void* tables_ = nullptr;
  std::uint64_t tables_size_ = 0;
  void* owned_bytes_ = nullptr;
  std::uint64_t owned_size_ = 0;
};
