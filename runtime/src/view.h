#pragma once
// One camera: the set it sees, as runs, and the one before. move and move_box are the only things that change it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "db.h"

// In the global namespace since the C API names it.
struct sightcell_view {
 public:
  static sightcell_status create(const sightcell_db& db, sightcell_view** out) noexcept;
  static void destroy(sightcell_view* view) noexcept;

  // eye, min and max may be null: that is a wrong argument like a NaN.
  sightcell_status move(const float* eye, sightcell_frame& frame) noexcept;
  sightcell_status move_box(const float* min, const float* max, sightcell_frame& frame) noexcept;
  // False when nothing in a box can be seen. True for what is no box.
  [[nodiscard]] bool box_visible(const float min[3], const float max[3]) const noexcept;
  // Of a volume of the file, whatever the bytes may have become since.
  [[nodiscard]] bool volume_visible(std::uint32_t volume) const noexcept {
    return draws_all() || db_->volumes().is_visible(volume, visible_);
  }
  sightcell_status set_policy(std::uint32_t outside, float max_distance) noexcept;
  sightcell_status set_origin(const double origin[3]) noexcept;

  // From the next move on.
  sightcell_status show_named_group(std::uint32_t group, bool shown) noexcept;

  // A draw, or draw group of a merged file.
  [[nodiscard]] bool hides(std::uint32_t draw) const noexcept {
    const std::uint32_t group = db_->named_group_of(draw);
    return group != sightcell::format::no_named_group && (hidden_groups_[group / 64] >> group % 64 & 1) != 0;
  }

  [[nodiscard]] const sightcell_db& db() const noexcept { return *db_; }
  // Where the eye is; no_cell outside.
  [[nodiscard]] std::uint32_t cell() const noexcept { return at_.cell; }
  [[nodiscard]] const sightcell::format::box& cell_bounds() const noexcept { return at_.bounds; }
  [[nodiscard]] const sightcell::runtime::point& origin() const noexcept { return origin_; }
  // With struct_size and reserved as the caller has them.
  [[nodiscard]] const sightcell_view_stats& statistics() const noexcept { return counts_; }
  // True under DRAW_ALL. runs() has all polygons then, but those of hidden named groups, as always.
  [[nodiscard]] bool draws_all() const noexcept { return current_.everything; }
  // The set as runs of stored polygons, ascending.
  [[nodiscard]] std::span<const sightcell::format::run> runs() const noexcept { return current_.runs(); }
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return polygon_count_; }
  // The set as ranges of draws.
  [[nodiscard]] std::span<const sightcell_range> ranges() const noexcept { return {ranges_, current_.range_count}; }
  [[nodiscard]] std::uint32_t revision() const noexcept { return revision_; }
  // The set of revision() - 1; false when there is none, or when it or the current one is everything.
  [[nodiscard]] bool previous_runs(std::span<const sightcell::format::run>& out) const noexcept;

 private:
  // A set of polygons as runs in a buffer.
  struct polygon_set {
    std::span<sightcell::format::run> buffer;
    std::size_t count = 0;
    std::uint32_t range_count = 0;
    bool everything = false;  // that is shown: nothing is known

    [[nodiscard]] std::span<const sightcell::format::run> runs() const noexcept { return buffer.first(count); }
  };
  // A cell and its box.
  struct placed_cell {
    std::uint32_t cell = sightcell::runtime::no_cell;
    sightcell::format::box bounds;
  };
  // The answer of a search for the nearest cell, which holds until the eye is `slack` metres away from there.
  struct nearest_answer {
    placed_cell found;
    sightcell::runtime::point place{};
    double slack = -1.0;
  };
  static constexpr std::size_t most_cells = 64;  // that one box is looked up in

  sightcell_view() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] bool world_place(const float* eye, sightcell::runtime::point& out) const noexcept;
  [[nodiscard]] placed_cell locate(const sightcell::runtime::point& place) const noexcept;
  void stand_in(const placed_cell& where) noexcept;
  void go_to(const sightcell::runtime::point& place) noexcept;
  [[nodiscard]] bool find_rest(const sightcell::runtime::point& place) noexcept;
  void go_into(const sightcell::runtime::wide_box& closed) noexcept;
  void go_outside(const sightcell::runtime::point& place) noexcept;
  [[nodiscard]] const placed_cell& nearest_to(const sightcell::runtime::point& place) noexcept;
  void show_cell(const placed_cell& what, std::uint32_t flags) noexcept;
  void show_cells(std::span<sightcell::runtime::located_cell> cells, std::uint32_t flags) noexcept;
  void show_all(std::uint32_t flags) noexcept;
  [[nodiscard]] std::uint32_t decode(std::uint32_t cell, polygon_set& out,
                                     std::span<const sightcell::format::run>& volumes) noexcept;
  void show_next(std::uint32_t data_flags, std::uint32_t most_ranges) noexcept;
  void find_everything() noexcept;
  [[nodiscard]] bool leave_out_hidden() noexcept;
  void report(std::uint32_t revision_before, sightcell_frame& frame) noexcept;

  const sightcell_db* db_ = nullptr;
  std::uint64_t block_size_ = 0;
  // Where the eye is: the box of the cell, and the grown one in which it is kept. With settled_ the set of the cell is
  // shown, and move is done at once in rest_, into which no smaller cell reaches.
  sightcell::runtime::wide_box inside_, kept_, rest_;
  // Count of moves when rest_ was looked for, and from when on it may be again.
  std::uint64_t rested_from_ = 0, resting_again_ = 0;
  bool settled_ = false;
  bool shares_box_ = false;
  placed_cell at_;
  // What is shown: the set of one cell, or of several, or (both empty) everything.
  placed_cell shown_;
  std::array<std::uint32_t, most_cells> shown_cells_{};
  std::size_t shown_cell_count_ = 0;
  std::uint32_t place_flags_ = 0;  // OUTSIDE, and DRAW_ALL where that is not because of the data
  std::uint32_t data_flags_ = 0;   // DRAW_ALL with PENDING or DAMAGED
  // Five sets take turns: the previous one outlives a new cell with the same set, and a union needs two besides.
  polygon_set current_, previous_, next_, joined_, other_;
  // Of current_ and next_, in room for db's range bound: hosts that ask for ranges get them as they are here.
  sightcell_range* ranges_ = nullptr;
  sightcell_range* next_ranges_ = nullptr;
  std::span<std::byte> scratch_;
  // A bit for each volume that can be seen, as db's volume_index has them; nothing to be asked under DRAW_ALL.
  std::span<std::uint64_t> visible_, more_visible_;
  // Named groups that are not shown, a bit for each, and their polygons.
  std::span<std::uint64_t> hidden_groups_;
  polygon_set hidden_;
  bool regrouped_ = false;  // since the last move
  std::uint32_t polygon_count_ = 0;
  std::uint32_t revision_ = 0;
  bool moved_ = false;  // the first move always counts as a change
  sightcell_view_stats counts_{};
  // How the host set it up.
  sightcell::runtime::point origin_{};
  bool at_origin_ = true;  // of world space: then places are what hosts say
  std::uint32_t outside_ = SIGHTCELL_OUTSIDE_ALL;
  double max_distance_ = 0.0;
  placed_cell last_;  // the last cell that was shown from inside
  nearest_answer nearest_;
};
