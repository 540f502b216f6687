#pragma once
// One open file with the tables that open derives from it: the cell locator, the borders of ranges, and the states of
// the chunks of rows. Shared by threads; only the states of chunks change after open.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cell_locator.h"
#include "chunk_cache.h"
#include "memory.h"
#include "sightcell/format/importance_classes.h"
#include "sightcell/format/reader.h"
#include "volume_index.h"

namespace sightcell::runtime {

// Of a file that is in memory.
enum class chunk_state : std::uint8_t { unknown, good, damaged };

// Result of decoding a row.
enum class row_outcome : std::uint8_t { good, damaged, pending };

// The source of the polygons of a draw, or draw group of a merged file.
struct range_source {
  std::uint32_t first_source = 0;
  std::uint32_t order_begin = 0;  // offset of its order in orders_
  std::uint32_t base_vertex = 0;  // vertices of all draws before it in source order; 0 for draw groups
};

}  // namespace sightcell::runtime

// In the global namespace, because the C API declares it.
struct sightcell_db {
 public:
  // bytes: not copied. owned_bytes: a block of mem that contains them and is released with the db, or null.
  static sightcell_status open(std::span<const std::byte> bytes, const sightcell_allocator& mem, void* owned_bytes,
                               sightcell_db** out) noexcept;
  // Returns PENDING, OK or a failure. out is set before the first request, for deliver, and set to null on failure.
  static sightcell_status begin_source(const sightcell_source& source, const sightcell_allocator& mem,
                                       std::uint64_t resident_bytes, sightcell_db** out) noexcept;
  sightcell_status continue_opening() noexcept;
  [[nodiscard]] bool is_open() const noexcept { return step_.load(std::memory_order_acquire) == opening_step::open; }
  static void close(sightcell_db* db) noexcept;

  [[nodiscard]] const sightcell::format::reader& file() const noexcept { return file_; }
  [[nodiscard]] const sightcell_allocator& allocator() const noexcept { return mem_; }
  [[nodiscard]] const sightcell::runtime::cell_locator& locator() const noexcept { return locator_; }
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return file_.polygon_count(); }

  // Stored number of the first polygon of each draw, or draw group of a merged file, ascending, then polygon_count. A
  // checked copy: the bytes of the file may change.
  [[nodiscard]] std::span<const std::uint32_t> range_borders() const noexcept { return range_borders_; }
  // The named group of a draw, or draw group of a merged file; format::no_named_group for most.
  [[nodiscard]] std::uint32_t named_group_of(std::uint32_t draw) const noexcept {
    return named_groups_.empty() ? sightcell::format::no_named_group : named_groups_[draw];
  }
  // The number of draws, or draw groups, in named groups: the most runs of stored polygons that can be hidden.
  [[nodiscard]] std::uint32_t named_range_count() const noexcept { return named_ranges_; }
  // The most ranges of any output, that of everything included.
  [[nodiscard]] std::uint32_t range_bound() const noexcept;

  // The code tables of the file; null in version 0.
  [[nodiscard]] const sightcell::format::row_codes* codes() const noexcept { return codes_; }
  // The polygons of a range, as numbers to which first_source of their draw, or draw group, is added.
  [[nodiscard]] std::span<const std::uint32_t> sources_in(std::uint32_t draw, std::uint32_t first,
                                                          std::uint32_t count) const noexcept {
    return orders_.subspan(range_sources_[draw].order_begin + first, count);
  }
  // 0 for draw groups, whose polygons are not consecutive in the source.
  [[nodiscard]] std::uint32_t first_source(std::uint32_t draw) const noexcept {
    return range_sources_[draw].first_source;
  }

  [[nodiscard]] std::uint32_t base_vertex(std::uint32_t draw) const noexcept {
    return range_sources_[draw].base_vertex;
  }
  [[nodiscard]] bool is_merged() const noexcept;
  // Finds the draw of a polygon of a draw group in a merged file. near: tested first, and receives the result.
  void find_draw(std::uint32_t group, std::uint32_t source, std::uint32_t& near) const noexcept;
  // The draws of draw group g are draws_begin(g) .. draws_begin(g + 1) - 1.
  [[nodiscard]] std::uint32_t draws_begin(std::uint32_t group) const noexcept { return group_draws_[group]; }

  // Decodes the set of a cell. Checks its chunk at the first use and remembers the result; requests it if it is not in
  // memory. out, scratch, parts: as in reader::decode_row. Damaged: a wrong checksum, or bytes that are not a row.
  [[nodiscard]] sightcell::runtime::row_outcome decode(std::uint32_t cell, std::span<sightcell::format::run> out,
                                                       std::span<std::byte> scratch,
                                                       sightcell::format::row_parts& parts) const noexcept;
  // False also for a paged file.
  [[nodiscard]] bool has_importance() const noexcept { return file_.has_importance() && !is_paged(); }
  // Opens the importance section, which open() does not check, for a cell. Checks the chunk of the cell at the first
  // use and remembers the result. Only if has_importance().
  [[nodiscard]] sightcell_status open_importance(std::uint32_t cell,
                                                 sightcell::format::importance_classes& out) const noexcept;
  // Empty for a file without volumes.
  [[nodiscard]] const sightcell::runtime::volume_index& volumes() const noexcept { return volumes_; }

  [[nodiscard]] bool is_paged() const noexcept { return source_.request != nullptr; }
  // Only if is_paged().
  [[nodiscard]] sightcell::runtime::chunk_cache& cache() const noexcept { return cache_; }
  sightcell_status deliver(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept;

  [[nodiscard]] sightcell_status check() const noexcept;
  // Bytes of the allocator that the db holds until it is closed.
  [[nodiscard]] std::uint64_t memory_bytes() const noexcept {
    return block_size_ + tables_size_ + (owned_bytes_ == nullptr ? 0 : owned_size_);
  }

 private:
  // What of the file is requested next, or is awaited.
  enum class opening_step : std::uint8_t { header, header_awaited, front_awaited, open };
  enum class delivery : std::uint8_t { none, awaited, arriving, arrived, unreadable };
  struct opening_request {
    std::span<std::byte> target;
    std::uint32_t ticket = 0;
    std::atomic<delivery> state = delivery::none;
  };

  sightcell_db() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] sightcell_status fill() noexcept;
  [[nodiscard]] bool fill_ranges() noexcept;
  [[nodiscard]] bool fill_draws_of_groups() noexcept;
  [[nodiscard]] bool fill_named_groups() noexcept;
  [[nodiscard]] bool cell_is_sound(std::uint32_t cell) const noexcept;
  [[nodiscard]] sightcell_status ask(std::span<std::byte> target) noexcept;
  [[nodiscard]] sightcell_status take_header() noexcept;
  [[nodiscard]] sightcell_status take_front() noexcept;
  sightcell_status deliver_opening(std::uint32_t ticket, const void* bytes, std::uint32_t size) noexcept;

  sightcell::format::reader file_;
  sightcell_allocator mem_{};
  sightcell::runtime::cell_locator locator_;
  sightcell::runtime::locator_memory cells_;
  sightcell::runtime::volume_index volumes_;
  std::span<std::uint32_t> range_borders_;
  std::span<sightcell::runtime::range_source> range_sources_;
  // All orders, one after the other; instances share them. Source ids in a merged file, where nothing is shared.
  std::span<std::uint32_t> orders_;
  // For a merged file: first draw of each group, then the draw count; source id of each draw's first polygon.
  std::span<std::uint32_t> group_draws_, draw_sources_;
  // By draw, or draw group; empty if the file has no named groups.
  std::span<std::uint32_t> named_groups_;
  std::span<std::byte> codes_memory_;
  const sightcell::format::row_codes* codes_ = nullptr;
  // For a file that is in memory: chunks of rows, then, if has_importance(), chunks of importance. Threads that check
  // the same chunk at once write the same result, so no lock is needed.
  std::span<std::atomic<sightcell::runtime::chunk_state>> chunks_;
  std::uint32_t whole_ranges_ = 0;  // draws, or draw groups, that have polygons: the ranges of everything
  std::uint32_t named_ranges_ = 0;
  // For a paged file.
  sightcell_source source_{};
  opening_request opening_;
  std::atomic<opening_step> step_ = opening_step::header;
  std::array<std::byte, sightcell::format::reader::most_header_bytes> header_{};
  std::uint64_t resident_bytes_ = 0;
  mutable sightcell::runtime::chunk_cache cache_;
  std::span<sightcell::runtime::cached_chunk> cached_;
  std::span<std::uint32_t> cached_order_;
  std::span<std::byte> room_;
  // Blocks that close releases: the db with its tables, or, for a paged file, the tables apart.
  std::uint64_t block_size_ = 0;
  void* tables_ = nullptr;
  std::uint64_t tables_size_ = 0;
  void* owned_bytes_ = nullptr;
  std::uint64_t owned_size_ = 0;
};
