#pragma once
// One camera: its current set as runs, and the previous one. Only move and move_box change them.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "db.h"

// In the global namespace, because the C API declares it.
struct sightcell_view {
 public:
  static sightcell_status create(const sightcell_db& db, sightcell_view** out) noexcept;
  static void destroy(sightcell_view* view) noexcept;

  // eye, min and max may be null: that is a wrong argument, like a NaN.
  sightcell_status move(const float* eye, sightcell_frame& frame) noexcept;
  sightcell_status move_box(const float* min, const float* max, sightcell_frame& frame) noexcept;
  // False if nothing in a box can be visible. True if min and max are not a box.
  [[nodiscard]] bool box_visible(const float min[3], const float max[3]) const noexcept;
  // volume: of the file, also if its bytes changed since open.
  [[nodiscard]] bool volume_visible(std::uint32_t volume) const noexcept {
    return draws_all() || db_->volumes().is_visible(volume, visible_);
  }
  sightcell_status set_policy(std::uint32_t outside, float max_distance) noexcept;
  sightcell_status set_origin(const double origin[3]) noexcept;

  // Takes effect with the next move.
  sightcell_status show_named_group(std::uint32_t group, bool shown) noexcept;

  // draw: a draw, or draw group of a merged file.
  [[nodiscard]] bool is_hidden(std::uint32_t draw) const noexcept {
    const std::uint32_t group = db_->named_group_of(draw);
    return group != sightcell::format::no_named_group && (hidden_groups_[group / 64] >> group % 64 & 1) != 0;
  }

  [[nodiscard]] const sightcell_db& db() const noexcept { return *db_; }
  // The cell that contains the eye; no_cell outside.
  [[nodiscard]] std::uint32_t cell() const noexcept { return at_.cell; }
  [[nodiscard]] const sightcell::format::box& cell_bounds() const noexcept { return at_.bounds; }
  [[nodiscard]] const sightcell::runtime::point& origin() const noexcept { return origin_; }
  // struct_size and reserved are not set.
  [[nodiscard]] const sightcell_view_stats& statistics() const noexcept { return counts_; }
  // True under DRAW_ALL. runs() then has all polygons except those of hidden named groups.
  [[nodiscard]] bool draws_all() const noexcept { return current_.everything; }
  // The set as runs of stored polygons, ascending.
  [[nodiscard]] std::span<const sightcell::format::run> runs() const noexcept { return current_.runs(); }
  [[nodiscard]] std::uint32_t polygon_count() const noexcept { return polygon_count_; }
  // The set as ranges of draws.
  [[nodiscard]] std::span<const sightcell_range> ranges() const noexcept { return {ranges_, current_.range_count}; }
  [[nodiscard]] std::uint32_t revision() const noexcept { return revision_; }
  // The cells whose sets are shown: one, several, or none if everything is shown.
  [[nodiscard]] std::span<const std::uint32_t> shown_cells() const noexcept {
    if (draws_all() || !moved_) return {};
    if (shown_cell_count_ > 0) return std::span(shown_cells_).first(shown_cell_count_);
    return {&shown_.cell, 1};
  }
  // Decodes the set of a cell again, with the polygons of hidden named groups. False if its bytes changed since the
  // move, or have been removed from the memory of a paged file. out: valid until the next call or move.
  [[nodiscard]] bool whole_set_of(std::uint32_t cell, std::span<const sightcell::format::run>& out) const noexcept;
  // The set of revision() - 1. False if there is none, or if it or the current one is everything.
  [[nodiscard]] bool previous_runs(std::span<const sightcell::format::run>& out) const noexcept;

 private:
  // A set of polygons as runs in a buffer.
  struct polygon_set {
    std::span<sightcell::format::run> buffer;
    std::size_t count = 0;
    std::uint32_t range_count = 0;
    bool everything = false;  // the visible polygons are not known

    [[nodiscard]] std::span<const sightcell::format::run> runs() const noexcept { return buffer.first(count); }
  };
  // A cell and its box.
  struct placed_cell {
    std::uint32_t cell = sightcell::runtime::no_cell;
    sightcell::format::box bounds;
  };
  // Result of a search for the nearest cell. It holds within slack meters of the position.
  struct nearest_answer {
    placed_cell found;
    sightcell::runtime::point position{};
    double slack = -1.0;
  };
  static constexpr std::size_t most_cells = 64;  // of a union

  sightcell_view() = default;
  [[nodiscard]] std::uint64_t carve(void* block) noexcept;
  [[nodiscard]] bool world_position(const float* eye, sightcell::runtime::point& out) const noexcept;
  [[nodiscard]] placed_cell locate(const sightcell::runtime::point& position) const noexcept;
  void enter(const placed_cell& where) noexcept;
  void go_to(const sightcell::runtime::point& position) noexcept;
  [[nodiscard]] bool find_rest(const sightcell::runtime::point& position) noexcept;
  void go_into(const sightcell::runtime::wide_box& closed) noexcept;
  void go_outside(const sightcell::runtime::point& position) noexcept;
  [[nodiscard]] const placed_cell& nearest_to(const sightcell::runtime::point& position) noexcept;
  void show_cell(const placed_cell& what, std::uint32_t flags, const sightcell::runtime::point& position) noexcept;
  void show_cells(std::span<sightcell::runtime::located_cell> cells, std::uint32_t flags,
                  const sightcell::runtime::point& position) noexcept;
  [[nodiscard]] bool keeps_shown(const sightcell::runtime::point& position) const noexcept;
  [[nodiscard]] bool any_is_pending(std::span<const sightcell::runtime::located_cell> cells) noexcept;
  void show_all(std::uint32_t flags) noexcept;
  [[nodiscard]] std::uint32_t decode(std::uint32_t cell, polygon_set& out,
                                     std::span<const sightcell::format::run>& volumes) noexcept;
  void show_next(std::uint32_t data_flags, std::uint32_t most_ranges) noexcept;
  void find_everything() noexcept;
  [[nodiscard]] bool leave_out_hidden() noexcept;
  void report(std::uint32_t revision_before, sightcell_frame& frame) noexcept;

  const sightcell_db* db_ = nullptr;
  std::uint64_t block_size_ = 0;
  // The box of the cell that contains the eye, and its grown box, in which the view keeps the cell. If settled_, the
  // set of the cell is shown, and a move inside rest_ needs no search: no smaller cell intersects rest_.
  sightcell::runtime::wide_box inside_, kept_, rest_;
  // The number of moves when rest_ was last searched for, and from which on it may be searched for again.
  std::uint64_t rested_from_ = 0, resting_again_ = 0;
  bool settled_ = false;
  bool shares_box_ = false;
  placed_cell at_;
  // What is shown: the set of one cell, the union of several, or (if both are empty) everything.
  placed_cell shown_;
  std::array<std::uint32_t, most_cells> shown_cells_{};
  std::size_t shown_cell_count_ = 0;
  sightcell::runtime::wide_box shown_box_;  // around these cells
  std::uint32_t eye_flags_ = 0;             // OUTSIDE, and DRAW_ALL for reasons other than the data
  // DRAW_ALL with PENDING or DAMAGED; PENDING alone where another cell has not arrived and what is shown is kept.
  std::uint32_t data_flags_ = 0;
  // Five buffers in rotation: the previous set must survive a new cell with an equal set, and a union needs two more.
  polygon_set current_, previous_, next_, joined_, other_;
  // The ranges of current_ and next_, in db's range bound. sightcell_view_ranges copies the current ones.
  sightcell_range* ranges_ = nullptr;
  sightcell_range* next_ranges_ = nullptr;
  std::span<std::byte> scratch_;
  // A bit for each visible volume, by db's volume_index. Not used under DRAW_ALL.
  std::span<std::uint64_t> visible_, more_visible_;
  // Hidden named groups, a bit for each, and their polygons.
  std::span<std::uint64_t> hidden_groups_;
  polygon_set hidden_;
  bool regrouped_ = false;  // a named group was shown or hidden since the last move
  std::uint32_t polygon_count_ = 0;
  std::uint32_t revision_ = 0;
  bool moved_ = false;  // the first move always counts as a change
  sightcell_view_stats counts_{};
  // What the host has set.
  sightcell::runtime::point origin_{};
  bool at_origin_ = true;  // origin_ is 0: positions are the host's floats
  std::uint32_t outside_ = SIGHTCELL_OUTSIDE_ALL;
  bool pending_last_ = false;  // SIGHTCELL_PENDING_LAST
  double max_distance_ = 0.0;
  placed_cell last_;  // the last cell that the eye was in
  nearest_answer nearest_;
};
