#pragma once
// One open file and what is derived from it at open: the cell locator, the borders of the draws, and which chunks of
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

// Where the polygons of a draw come from.
struct draw_source {
  std::uint32_t first_source = 0;
  std::uint32_t order_begin = 0;  // place of its order among all orders
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

  // Stored number of each draw's first polygon, ascending, then polygon_count: one more than there are draws. A checked
  // copy: the file's bytes may change.
  [[nodiscard]] std::span<const std::uint32_t> draw_borders() const noexcept { return draw_borders_; }
  // Draws that have polygons: the ranges of everything.
  [[nodiscard]] std::uint32_t filled_draw_count() const noexcept { return filled_draws_; }
  // The most ranges any answer has, everything included.
  [[nodiscard]] std::uint32_t range_bound() const noexcept;

  // The code tables of the file; null in version 0.
  [[nodiscard]] const sightcell::format::row_codes* codes() const noexcept { return codes_; }
  // Which polygons of its draw, as the source has them, are stored from a draw's stored polygon `first` on.
  [[nodiscard]] std::span<const std::uint32_t> sources_in(std::uint32_t draw, std::uint32_t first,
                                                          std::uint32_t count) const noexcept {
    return orders_.subspan(draw_sources_[draw].order_begin + first, count);
  }
  [[nodiscard]] std::uint32_t first_source(std::uint32_t draw) const noexcept {
    return draw_sources_[draw].first_source;
  }

  // Checks the chunk of a cell at its first use and remembers the answer. False when it is damaged.
  [[nodiscard]] bool cell_is_sound(std::uint32_t cell) const noexcept;

  [[nodiscard]] sightcell_status check() const noexcept;

 private:
  sightcell_db() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] bool fill() noexcept;

  sightcell::format::reader file_;
  sightcell_allocator mem_{};
  sightcell::runtime::cell_locator locator_;
  std::span<sightcell::runtime::located_cell> cells_;
  std::span<sightcell::runtime::locator_node> nodes_;
  std::span<std::uint32_t> draw_borders_;
  std::span<sightcell::runtime::draw_source> draw_sources_;
  std::span<std::uint32_t> orders_;  // of all orders, one behind the other; all below the count of their draws
  std::span<std::byte> codes_memory_;
  const sightcell::format::row_codes* codes_ = nullptr;
  // Threads may check the same chunk at once and write the same answer: no lock needed.
  std::span<std::atomic<sightcell::runtime::chunk_state>> chunks_;
  std::uint32_t filled_draws_ = 0;
  std::uint64_t block_size_ = 0;
  void* owned_bytes_ = nullptr;
  std::uint64_t owned_size_ = 0;
};
