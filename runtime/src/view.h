#pragma once
// One camera: the set it sees, as runs, and the one before. move is the only thing that changes it.
#include <cstddef>
#include <cstdint>
#include <span>

#include "db.h"

// In the global namespace since the C API names it.
struct sightcell_view {
 public:
  static sightcell_status create(const sightcell_db& db, sightcell_view** out) noexcept;
  static void destroy(sightcell_view* view) noexcept;

  // eye may be null: that is a wrong argument like a NaN.
  sightcell_status move(const float* eye, sightcell_frame& frame) noexcept;

  [[nodiscard]] const sightcell_db& db() const noexcept { return *db_; }
  // True under DRAW_ALL; runs() is empty then.
  [[nodiscard]] bool draws_all() const noexcept { return current_.everything; }
  // The set as runs of stored polygons, ascending.
  [[nodiscard]] std::span<const sightcell::format::run> runs() const noexcept { return current_.runs(); }
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return polygon_count_; }
  // The set as ranges of draws; under DRAW_ALL there are range_count() and none is here.
  [[nodiscard]] std::span<const sightcell_range> ranges() const noexcept {
    return {ranges_, draws_all() ? 0 : range_count()};
  }
  [[nodiscard]] std::uint32_t range_count() const noexcept { return current_.range_count; }
  [[nodiscard]] std::uint32_t revision() const noexcept { return revision_; }
  // The set of revision() - 1; false when there is none, or when it or the current one is everything.
  [[nodiscard]] bool previous_runs(std::span<const sightcell::format::run>& out) const noexcept;

 private:
  // A set of polygons: runs in a buffer of db's run bound, or everything.
  struct polygon_set {
    sightcell::format::run* buffer = nullptr;
    std::size_t count = 0;
    std::uint32_t range_count = 0;
    bool everything = false;

    [[nodiscard]] std::span<const sightcell::format::run> runs() const noexcept { return {buffer, count}; }
  };

  sightcell_view() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] std::uint32_t locate(const float eye[3], sightcell::format::box& bounds) const noexcept;
  void enter(std::uint32_t cell, const sightcell::format::box& bounds) noexcept;
  void leave(std::uint32_t flags) noexcept;
  [[nodiscard]] bool decode_next(std::uint32_t cell) noexcept;
  void show_next() noexcept;
  void report(std::uint32_t revision_before, sightcell_frame& frame) const noexcept;

  const sightcell_db* db_ = nullptr;
  std::uint64_t block_size_ = 0;
  // Three sets take turns, so that the previous one outlives a new cell with the same set.
  polygon_set current_, previous_, next_;
  // Of current_ and next_, in room for db's range bound: hosts that ask for ranges get them as they are here.
  sightcell_range* ranges_ = nullptr;
  sightcell_range* next_ranges_ = nullptr;
  std::span<std::byte> scratch_;
  sightcell::format::box bounds_;  // of cell_
  bool shares_box_ = false;        // a smaller cell reaches into it
  std::uint32_t cell_ = sightcell::runtime::no_cell;
  std::uint32_t flags_ = 0;  // all but CHANGED
  std::uint32_t polygon_count_ = 0;
  std::uint32_t revision_ = 0;
  bool moved_ = false;  // the first move always counts as a change
};
