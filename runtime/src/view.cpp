#include "view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "ranges.h"

using sightcell::runtime::any_volume;
using sightcell::runtime::no_cell;
namespace format = sightcell::format;

std::uint64_t sightcell_view::carve(void* block) noexcept {
  sightcell::runtime::carver space(block);
  const std::size_t room = db_->file().run_bound();
  space.take<sightcell_view>(1);
  const auto take_runs = [&] {
    auto* runs = space.take<format::run>(room);
    if (runs != nullptr) std::uninitialized_value_construct_n(runs, room);
    return runs;
  };
  current_.buffer = take_runs();
  previous_.buffer = take_runs();
  next_.buffer = take_runs();
  const auto take_ranges = [&] {
    auto* ranges = space.take<sightcell_range>(db_->file().range_bound());
    if (ranges != nullptr) std::uninitialized_value_construct_n(ranges, db_->file().range_bound());
    return ranges;
  };
  ranges_ = take_ranges();
  next_ranges_ = take_ranges();
  static_cast<void>(space.take<std::uint32_t>(0));  // scratch lies at a multiple of 4
  auto* scratch = space.take<std::byte>(db_->file().scratch_size());
  if (scratch != nullptr) scratch_ = {scratch, db_->file().scratch_size()};
  return space.used();
}

sightcell_status sightcell_view::create(const sightcell_db& db, sightcell_view** out) noexcept {
  sightcell_view plan;
  plan.db_ = &db;
  const std::uint64_t size = plan.carve(nullptr);
  void* block = sightcell::runtime::allocate(db.allocator(), size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* view = new (block) sightcell_view(plan);
  view->block_size_ = size;
  static_cast<void>(view->carve(block));
  *out = view;
  return SIGHTCELL_OK;
}

void sightcell_view::destroy(sightcell_view* view) noexcept {
  if (view == nullptr) return;
  sightcell::runtime::release(view->db_->allocator(), view, view->block_size_);
}

// The old cell first: most frames end with the first line. In the rest of its grown box, and where smaller cells reach
// into it, a smaller one is looked for.
std::uint32_t sightcell_view::locate(const float eye[3], format::box& bounds) const noexcept {
  if (cell_ != no_cell && !shares_box_ && sightcell::runtime::box_holds(bounds_, eye)) return cell_;
  const auto& locator = db_->locator();
  if (cell_ != no_cell && sightcell::runtime::grown_box_holds(bounds_, db_->file().facts().margin, eye)) {
    const std::uint32_t smaller = locator.find(eye, sightcell::runtime::box_volume(bounds_), bounds);
    return smaller == no_cell ? cell_ : smaller;
  }
  return locator.find(eye, any_volume, bounds);
}

sightcell_status sightcell_view::move(const float* eye, sightcell_frame& frame) noexcept {
  const std::uint32_t before = revision_;
  constexpr float nowhere = std::numeric_limits<float>::quiet_NaN();
  const float place[3] = {eye == nullptr ? nowhere : eye[0], eye == nullptr ? nowhere : eye[1],
                          eye == nullptr ? nowhere : eye[2]};
  if (std::isnan(place[0]) || std::isnan(place[1]) || std::isnan(place[2])) {
    leave(SIGHTCELL_FRAME_DRAW_ALL);
    report(before, frame);
    return SIGHTCELL_ERR_ARGUMENT;
  }
  format::box bounds;
  const std::uint32_t cell = locate(place, bounds);
  if (cell == no_cell) {
    leave(SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE);
  } else if (cell != cell_) {
    enter(cell, bounds);
  }
  report(before, frame);
  return SIGHTCELL_OK;
}

void sightcell_view::enter(std::uint32_t cell, const format::box& bounds) noexcept {
  cell_ = cell;
  bounds_ = bounds;
  shares_box_ = db_->locator().has_smaller_inside(bounds, sightcell::runtime::box_volume(bounds));
  const bool sound = db_->cell_is_sound(cell) && decode_next(cell);
  flags_ = sound ? 0u : SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_DAMAGED;
  next_.everything = !sound;
  show_next();
}

void sightcell_view::leave(std::uint32_t flags) noexcept {
  cell_ = no_cell;
  flags_ = flags;
  next_.everything = true;
  show_next();
}

// False when the row is damaged, or breaks the bounds by which hosts size their buffers.
bool sightcell_view::decode_next(std::uint32_t cell) noexcept {
  const std::span<format::run> room(next_.buffer, db_->file().run_bound());
  if (db_->file().decode_row(cell, db_->codes(), room, scratch_, next_.count) != format::status::ok) return false;
  const std::span<sightcell_range> range_room(next_ranges_, db_->file().range_bound());
  const std::size_t ranges = sightcell::runtime::write_ranges(next_.runs(), db_->range_borders(), range_room);
  next_.range_count = static_cast<std::uint32_t>(ranges);
  return ranges <= range_room.size();
}

// Makes next_ the current set, unless it is the same.
void sightcell_view::show_next() noexcept {
  if (next_.everything) {
    next_.count = 0;
    next_.range_count = db_->whole_range_count();
  }
  const auto same_run = [](const format::run& a, const format::run& b) {
    return a.first == b.first && a.count == b.count;
  };
  const auto now = current_.runs();
  const auto then = next_.runs();
  if (moved_ && current_.everything == next_.everything &&
      std::equal(now.begin(), now.end(), then.begin(), then.end(), same_run)) {
    return;
  }
  std::swap(previous_, current_);
  std::swap(current_, next_);
  std::swap(ranges_, next_ranges_);
  moved_ = true;
  ++revision_;
  polygon_count_ = current_.everything ? db_->polygon_count() : 0;
  for (const format::run& r : current_.runs()) polygon_count_ += r.count;
}

void sightcell_view::report(std::uint32_t revision_before, sightcell_frame& frame) const noexcept {
  frame = sightcell_frame{};
  frame.cell = cell_;
  frame.flags = flags_;
  if (revision_ != revision_before) frame.flags |= SIGHTCELL_FRAME_CHANGED;
  frame.polygon_count = polygon_count_;
  frame.revision = revision_;
}

bool sightcell_view::previous_runs(std::span<const format::run>& out) const noexcept {
  if (!moved_ || previous_.everything || current_.everything) return false;
  out = previous_.runs();
  return true;
}
