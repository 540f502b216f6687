#pragma once
// One open file and what is derived from it at open: the cell locator, the borders of ranges, and which chunks of
// rows have been checked. Shared by threads; only the chunk states change after open.
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "cell_locator.h"
#include "memory.h"
#include "sightcell/format/reader.h"

namespace sightcell::runtime {

enum class chunk_state : std::uint8_t { unknown, good, damaged };

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
  static void close(sightcell_db* db) noexcept;

  [[nodiscard]] const sightcell::format::reader& file() const noexcept { return file_; }
  [[nodiscard]] const sightcell_allocator& allocator() const noexcept { return mem_; }
  [[nodiscard]] const sightcell::runtime::cell_locator& locator() const noexcept { return locator_; }
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return file_.polygon_count(); }

  // Stored number of the first polygon of each draw, or draw group of a merged file, ascending, then polygon_count. A
  // checked copy: the file's bytes may change.
  [[nodiscard]] std::span<const std::uint32_t> range_borders() const noexcept { return range_borders_; }
  // Draws, or draw groups, that have polygons: the ranges of everything.
  [[nodiscard]] std::uint32_t whole_range_count() const noexcept { return whole_ranges_; }
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

  // Checks the chunk of a cell at its first use and remembers the answer. False when it is damaged.
  [[nodiscard]] bool cell_is_sound(std::uint32_t cell) const noexcept;

  [[nodiscard]] sightcell_status check() const noexcept;

 private:
  sightcell_db() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] bool fill() noexcept;
  [[nodiscard]] bool fill_ranges() noexcept;

  sightcell::format::reader file_;
  sightcell_allocator mem_{};
  sightcell::runtime::cell_locator locator_;
  std::span<sightcell::runtime::located_cell> cells_;
  std::span<sightcell::runtime::locator_node> nodes_;
  std::span<std::uint32_t> range_borders_;
  std::span<sightcell::runtime::range_source> range_sources_;
  // All orders, one behind the other, which instances share; of a merged file, where nothing does, source ids.
  std::span<std::uint32_t> orders_;
  std::span<std::byte> codes_memory_;
  const sightcell::format::row_codes* codes_ = nullptr;
  // Threads may check the same chunk at once and write the same answer: no lock needed.
  std::span<std::atomic<sightcell::runtime::chunk_state>> chunks_;
  std::uint32_t whole_ranges_ = 0;
  std::uint64_t block_size_ = 0;
  void* owned_bytes_ = nullptr;
  std::uint64_t owned_size_ = 0;
};
