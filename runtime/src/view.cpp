#include "view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <utility>

#include "box_cover.h"
#include "ranges.h"
#include "set_union.h"

using namespace sightcell::runtime;
namespace format = sightcell::format;

std::uint64_t sightcell_view::carve(void* block) noexcept {
  carver space(block);
  space.take<sightcell_view>(1);
  const auto take = [&]<class T>(std::uint64_t count, T*& first) {
    first = space.take<T>(count);
    if (first != nullptr) sightcell::runtime::construct(first, count);
  };
  // A row has at most run_bound() runs, and a union of rows at most range_bound().
  const std::size_t room = std::max<std::size_t>(db_->range_bound(), db_->file().row_room());
  for (polygon_set* set : {&current_, &previous_, &next_, &joined_, &other_}) {
    format::run* runs = nullptr;
    take(room, runs);
    set->buffer = {runs, runs == nullptr ? 0 : room};
  }
  take(db_->range_bound(), ranges_);
  take(db_->range_bound(), next_ranges_);
  for (std::span<std::uint64_t>* words : {&visible_, &more_visible_}) {
    std::uint64_t* first = nullptr;
    take(db_->volumes().chunk_count(), first);
    *words = {first, first == nullptr ? 0 : db_->volumes().chunk_count()};
  }
  const std::uint64_t group_words = (std::uint64_t{db_->file().named_groups().count()} + 63) / 64;
  std::uint64_t* group_word = nullptr;
  take(group_words, group_word);
  hidden_groups_ = {group_word, group_word == nullptr ? 0 : static_cast<std::size_t>(group_words)};
  format::run* hidden = nullptr;
  take(db_->named_range_count(), hidden);
  hidden_.buffer = {hidden, hidden == nullptr ? 0 : db_->named_range_count()};
  static_cast<void>(space.take<std::uint32_t>(0));  // aligns scratch to 4
  auto* scratch = space.take<std::byte>(db_->file().scratch_size());
  if (scratch != nullptr) scratch_ = {scratch, db_->file().scratch_size()};
  return space.used();
}

sightcell_status sightcell_view::create(const sightcell_db& db, sightcell_view** out) noexcept {
  sightcell_view plan;
  plan.db_ = &db;
  const std::uint64_t size = plan.carve(nullptr);
  void* block = allocate(db.allocator(), size);
  if (block == nullptr) return SIGHTCELL_ERR_MEMORY;
  auto* view = new (block) sightcell_view(plan);
  view->block_size_ = size;
  static_cast<void>(view->carve(block));
  *out = view;
  return SIGHTCELL_OK;
}

void sightcell_view::destroy(sightcell_view* view) noexcept {
  if (view == nullptr) return;
  release(view->db_->allocator(), view, view->block_size_);
}

sightcell_status sightcell_view::set_policy(std::uint32_t outside, float max_distance) noexcept {
  const std::uint32_t flags = SIGHTCELL_PENDING_LAST;
  if ((outside & ~flags) > SIGHTCELL_OUTSIDE_LAST || !(max_distance >= 0.0f)) return SIGHTCELL_ERR_ARGUMENT;
  outside_ = outside & ~flags;
  pending_last_ = (outside & flags) != 0;
  max_distance_ = static_cast<double>(max_distance);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view::set_origin(const double origin[3]) noexcept {
  if (origin == nullptr) return SIGHTCELL_ERR_ARGUMENT;
  const point position{origin[0], origin[1], origin[2]};
  if (!std::isfinite(position[0]) || !std::isfinite(position[1]) || !std::isfinite(position[2]))
    return SIGHTCELL_ERR_ARGUMENT;
  origin_ = position;
  at_origin_ = position == point{};
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view::show_named_group(std::uint32_t group, bool shown) noexcept {
  if (group >= db_->file().named_groups().count()) return SIGHTCELL_ERR_ARGUMENT;
  std::uint64_t& word = hidden_groups_[group / 64];
  const std::uint64_t bit = std::uint64_t{1} << group % 64;
  if (((word & bit) == 0) == shown) return SIGHTCELL_OK;
  word ^= bit;
  hidden_.count = 0;
  const std::span<const std::uint32_t> borders = db_->range_borders();
  for (std::uint32_t draw = 0; draw + 1 < borders.size(); ++draw) {
    if (is_hidden(draw) && borders[draw] < borders[draw + 1]) {
      hidden_.buffer[hidden_.count++] = {borders[draw], borders[draw + 1] - borders[draw]};
    }
  }
  regrouped_ = true;
  settled_ = false;
  return SIGHTCELL_OK;
}

bool sightcell_view::world_position(const float* eye, point& out) const noexcept {
  if (eye == nullptr) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = origin_[axis] + static_cast<double>(eye[axis]);
  return !std::isnan(out[0]) && !std::isnan(out[1]) && !std::isnan(out[2]);
}

sightcell_status sightcell_view::move(const float* eye, sightcell_frame& frame) noexcept {
  const std::uint32_t before = revision_;
  point position;
  if (!world_position(eye, position)) {
    enter({});
    show_all(SIGHTCELL_FRAME_DRAW_ALL);
    report(before, frame);
    return SIGHTCELL_ERR_ARGUMENT;
  }
  if (!settled_ || !holds(rest_, position)) go_to(position);  // most frames do not call it
  report(before, frame);
  return SIGHTCELL_OK;
}

sightcell_status sightcell_view::move_box(const float* min, const float* max, sightcell_frame& frame) noexcept {
  const std::uint32_t before = revision_;
  wide_box closed;
  if (!world_position(min, closed.min) || !world_position(max, closed.max) || min[0] > max[0] || min[1] > max[1] ||
      min[2] > max[2]) {
    enter({});
    show_all(SIGHTCELL_FRAME_DRAW_ALL);
    report(before, frame);
    return SIGHTCELL_ERR_ARGUMENT;
  }
  go_into(closed);
  report(before, frame);
  return SIGHTCELL_OK;
}

// Keeps the old cell inside its grown box, and searches for a smaller one only where one reaches into that box.
sightcell_view::placed_cell sightcell_view::locate(const point& position) const noexcept {
  const cell_locator& locator = db_->locator();
  placed_cell found;
  if (at_.cell == no_cell || !holds(kept_, position)) {
    found.cell = locator.find(rounded_down(position), any_volume, found.bounds);
    return found;
  }
  if (!shares_box_ && holds(inside_, position)) return at_;
  found.cell = locator.find(rounded_down(position), volume_of(at_.bounds), found.bounds);
  return found.cell == no_cell ? at_ : found;
}

void sightcell_view::enter(const placed_cell& where) noexcept {
  if (where.cell != no_cell && where.cell != at_.cell) {
    inside_ = widened(where.bounds);
    kept_ = widened(where.bounds, db_->file().facts().margin);
    shares_box_ = db_->locator().has_smaller_inside(where.bounds, volume_of(where.bounds));
  }
  at_ = where;
  settled_ = false;
}

void sightcell_view::go_to(const point& position) noexcept {
  const std::uint32_t cell_before = at_.cell;
  enter(locate(position));
  if (at_.cell == no_cell) return go_outside(position);
  show_cell(at_, 0, position);
  last_ = at_;
  if (data_flags_ != 0) return;
  if (!shares_box_ && holds(inside_, position)) {
    rest_ = inside_;
    settled_ = true;
  } else if (at_.cell == cell_before) {
    // A camera that left its last resting boxes after few moves does not search for one for a while.
    constexpr std::uint64_t few = 4;
    constexpr std::uint64_t a_while = 32;
    if (counts_.moves - rested_from_ < few) resting_again_ = counts_.moves + a_while;
    if (counts_.moves < resting_again_) return;
    rested_from_ = counts_.moves;
    settled_ = find_rest(position);
  }
}

namespace {

// Cuts off the part of a region that intersects a box, along the axis on which the box is furthest from a position. The
// position is inside the region. False if it is inside the box.
bool cut_off(wide_box& region, const wide_box& away, const point& position) noexcept {
  std::size_t best = 3;
  bool above = false;  // the box is above the position on that axis
  double most = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double up = away.min[axis] - position[axis];
    const double down = position[axis] - away.max[axis];
    if (up <= 0.0 && down < 0.0) continue;
    const double apart = std::max(up, down);
    if (best < 3 && apart <= most) continue;
    best = axis;
    above = up > 0.0;
    most = apart;
  }
  if (best == 3) return false;
  if (above) {
    region.max[best] = std::min(region.max[best], away.min[best]);
  } else {
    region.min[best] = std::max(region.min[best], away.max[best]);
  }
  return true;
}

}  // namespace

// Sets rest_ to a box around a position inside the grown box of its cell that no smaller cell intersects. It covers
// only a part of the grown box, so that few cells have to be tested.
bool sightcell_view::find_rest(const point& position) noexcept {
  rest_ = kept_;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double reach = 0.25 * (inside_.max[axis] - inside_.min[axis]);
    rest_.min[axis] = std::max(rest_.min[axis], position[axis] - reach);
    rest_.max[axis] = std::min(rest_.max[axis], position[axis] + reach);
  }
  std::array<located_cell, most_cells> cells;
  const std::size_t count = db_->locator().touching(rest_, cells);
  if (count > cells.size()) return false;
  const double volume = volume_of(at_.bounds);
  const auto nearby = std::span(cells).first(count);
  return std::all_of(nearby.begin(), nearby.end(), [&](const located_cell& c) {
    return volume_of(c.bounds) >= volume || cut_off(rest_, widened(c.bounds), position);
  });
}

void sightcell_view::go_outside(const point& position) noexcept {
  const placed_cell& substitute = outside_ == SIGHTCELL_OUTSIDE_LAST      ? last_
                                  : outside_ == SIGHTCELL_OUTSIDE_NEAREST ? nearest_to(position)
                                                                          : at_;
  const bool near = substitute.cell != no_cell &&
                    squared_distance(widened(substitute.bounds), position) <= max_distance_ * max_distance_;
  if (!near) return show_all(SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE);
  show_cell(substitute, SIGHTCELL_FRAME_OUTSIDE, position);
}

const sightcell_view::placed_cell& sightcell_view::nearest_to(const point& position) noexcept {
  const wide_box known{nearest_.position, nearest_.position};
  if (squared_distance(known, position) <= nearest_.slack * nearest_.slack && nearest_.slack >= 0.0)
    return nearest_.found;
  nearest_search search(position);
  db_->locator().nearest(search);
  nearest_ = {{search.cell(), search.bounds()}, position, search.slack()};
  return nearest_.found;
}

void sightcell_view::go_into(const wide_box& closed) noexcept {
  point center;
  for (std::size_t axis = 0; axis < 3; ++axis) center[axis] = 0.5 * closed.min[axis] + 0.5 * closed.max[axis];
  if (closed.min == closed.max) return go_to(closed.min);
  enter(locate(center));
  // Both ends of the box, because kept_ is half-open.
  if (at_.cell != no_cell && holds(kept_, closed.min) && holds(kept_, closed.max)) {
    show_cell(at_, 0, center);
    last_ = at_;
    return;
  }
  std::array<located_cell, most_cells> cells;
  const std::size_t count = db_->locator().touching(closed, cells);
  if (count == 0) return go_outside(center);
  if (count > cells.size()) return show_all(SIGHTCELL_FRAME_DRAW_ALL);
  const std::span<located_cell> touched(cells.data(), count);
  const bool covered = cells_cover(closed, touched, db_->file().facts().margin);
  if (!covered && outside_ == SIGHTCELL_OUTSIDE_ALL) {
    return show_all(SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_OUTSIDE);
  }
  show_cells(touched, covered ? 0u : std::uint32_t{SIGHTCELL_FRAME_OUTSIDE}, center);
}

// Returns whether the set that is shown stays while another one has not arrived.
bool sightcell_view::keeps_shown(const point& position) const noexcept {
  return pending_last_ && moved_ && !current_.everything && !regrouped_ &&
         squared_distance(shown_box_, position) <= max_distance_ * max_distance_;
}

// Shows the set of a cell, unless it is shown already. Requests a pending one again.
void sightcell_view::show_cell(const placed_cell& what, std::uint32_t flags, const point& position) noexcept {
  constexpr std::uint32_t without_set = SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_PENDING;
  eye_flags_ = flags;
  if (moved_ && shown_.cell == what.cell && !regrouped_ && data_flags_ != without_set) {
    if (data_flags_ == SIGHTCELL_FRAME_PENDING) data_flags_ = 0;  // back in the cell whose set was kept
    return;
  }
  std::span<const format::run> volumes;
  const std::uint32_t data_flags = decode(what.cell, next_, volumes);
  if (data_flags == without_set && keeps_shown(position)) {
    data_flags_ = SIGHTCELL_FRAME_PENDING;
    return;
  }
  shown_box_ = widened(what.bounds);
  next_.everything = data_flags != 0;
  db_->volumes().show(volumes, visible_);
  shown_ = what;
  shown_cell_count_ = 0;
  show_next(data_flags, db_->file().range_bound());
}

// Shows the union of several sets, in the order of the cells' numbers, so that it does not depend on the search.
void sightcell_view::show_cells(std::span<located_cell> cells, std::uint32_t flags, const point& position) noexcept {
  eye_flags_ = flags;
  sort_by_number(cells);
  const bool same = shown_cell_count_ == cells.size() &&
                    std::equal(cells.begin(), cells.end(), shown_cells_.begin(),
                               [](const located_cell& c, std::uint32_t shown) { return c.cell == shown; });
  if (same && !regrouped_ && (data_flags_ & SIGHTCELL_FRAME_PENDING) == 0) return;
  if (keeps_shown(position) && any_is_pending(cells)) {
    data_flags_ = SIGHTCELL_FRAME_PENDING;
    return;
  }
  std::uint32_t data_flags = 0;
  next_.count = 0;
  std::fill(visible_.begin(), visible_.end(), 0);
  for (const located_cell& c : cells) {
    std::span<const format::run> volumes;
    data_flags |= decode(c.cell, other_, volumes);  // also after a failure, so that all are requested
    db_->volumes().show(volumes, more_visible_);
    for (std::size_t i = 0; i < visible_.size(); ++i) visible_[i] |= more_visible_[i];
    if (data_flags != 0) continue;
    if (!write_union(next_.runs(), other_.runs(), db_->range_borders(), db_->range_bound(), joined_.buffer,
                     joined_.count)) {
      data_flags = SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_DAMAGED;
    }
    std::swap(next_, joined_);
  }
  next_.everything = data_flags != 0;
  shown_ = {};
  shown_cell_count_ = cells.size();
  std::transform(cells.begin(), cells.end(), shown_cells_.begin(), [](const located_cell& c) { return c.cell; });
  shown_box_ = widened(cells.front().bounds);
  for (const located_cell& c : cells) {
    const wide_box b = widened(c.bounds);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      shown_box_.min[axis] = std::min(shown_box_.min[axis], b.min[axis]);
      shown_box_.max[axis] = std::max(shown_box_.max[axis], b.max[axis]);
    }
  }
  show_next(data_flags, db_->range_bound());
}

// Requests the sets of all cells. other_ is used within a move only.
bool sightcell_view::any_is_pending(std::span<const located_cell> cells) noexcept {
  bool pending = false;
  format::row_parts parts;
  for (const located_cell& c : cells)
    pending |= db_->decode(c.cell, other_.buffer, scratch_, parts) == row_outcome::pending;
  return pending;
}

void sightcell_view::show_all(std::uint32_t flags) noexcept {
  eye_flags_ = flags;
  shown_ = {};
  shown_cell_count_ = 0;
  if (moved_ && current_.everything && !regrouped_) {  // as in most frames outside
    data_flags_ = 0;
    return;
  }
  next_.everything = true;
  show_next(0, db_->range_bound());
}

// Returns 0, or the flags that explain why there is no set.
std::uint32_t sightcell_view::decode(std::uint32_t cell, polygon_set& out,
                                     std::span<const format::run>& volumes) noexcept {
  format::row_parts parts;
  const row_outcome outcome = db_->decode(cell, out.buffer, scratch_, parts);
  out.count = parts.polygons.size();  // they are at the begin of the buffer
  volumes = parts.volumes;
  counts_.rows_decoded += outcome == row_outcome::good ? 1 : 0;
  if (outcome == row_outcome::good) return 0;
  if (outcome == row_outcome::pending) return SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_PENDING;
  return SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_DAMAGED;
}

bool sightcell_view::box_visible(const float min[3], const float max[3]) const noexcept {
  if (draws_all()) return true;
  if (at_origin_) return db_->volumes().box_visible(min, max, visible_);
  // Rounded outward: the box may only become larger.
  point low;
  point high;
  if (!world_position(min, low) || !world_position(max, high)) return true;
  const rounded_point from = rounded_down(low);
  rounded_point to = rounded_down({-high[0], -high[1], -high[2]});
  for (float& end : to) end = -end;
  return db_->volumes().box_visible(from.data(), to.data(), visible_);
}

// Removes hidden named groups from next_. False if joined_ has not enough room, which no valid row causes: whole draws
// are removed, so that the rest has no more runs than the set has ranges.
bool sightcell_view::leave_out_hidden() noexcept {
  if (hidden_.count == 0) return true;
  const bool everything = next_.everything;
  joined_.count = write_difference(next_.runs(), hidden_.runs(), joined_.buffer);
  if (joined_.count > joined_.buffer.size()) return false;
  std::swap(next_, joined_);
  next_.everything = everything;
  return true;
}

void sightcell_view::find_everything() noexcept {
  next_.everything = true;
  next_.count = 0;
  if (db_->polygon_count() == 0) return;
  next_.buffer[next_.count++] = {0, db_->polygon_count()};
  static_cast<void>(leave_out_hidden());
}

// Makes next_ the current set, unless both are equal.
void sightcell_view::show_next(std::uint32_t data_flags, std::uint32_t most_ranges) noexcept {
  data_flags_ = data_flags;
  regrouped_ = false;
  const auto find_ranges = [&](std::uint32_t most) {
    next_.range_count =
        static_cast<std::uint32_t>(write_ranges(next_.runs(), db_->range_borders(), {next_ranges_, most}));
    return next_.range_count <= most;
  };
  if (!next_.everything && !(leave_out_hidden() && find_ranges(most_ranges))) {  // not a row that the file can have
    data_flags_ = SIGHTCELL_FRAME_DRAW_ALL | SIGHTCELL_FRAME_DAMAGED;
    next_.everything = true;
  }
  if (next_.everything) {
    find_everything();
    static_cast<void>(find_ranges(db_->range_bound()));
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
  polygon_count_ = 0;
  for (const format::run& r : current_.runs()) polygon_count_ += r.count;
}

void sightcell_view::report(std::uint32_t revision_before, sightcell_frame& frame) noexcept {
  frame = sightcell_frame{};
  frame.cell = at_.cell;
  frame.flags = eye_flags_ | data_flags_;
  if (revision_ != revision_before) frame.flags |= SIGHTCELL_FRAME_CHANGED;
  frame.polygon_count = polygon_count_;
  frame.revision = revision_;
  const auto has = [&](std::uint32_t flag) { return std::uint64_t{(frame.flags & flag) != 0}; };
  ++counts_.moves;
  counts_.polygons += polygon_count_;
  if (frame.flags == 0) return;  // most frames
  counts_.changes += has(SIGHTCELL_FRAME_CHANGED);
  counts_.moves_outside += has(SIGHTCELL_FRAME_OUTSIDE);
  counts_.moves_pending += has(SIGHTCELL_FRAME_PENDING);
  counts_.moves_draw_all += has(SIGHTCELL_FRAME_DRAW_ALL);
}

// joined_ is used within a move only.
bool sightcell_view::whole_set_of(std::uint32_t cell, std::span<const format::run>& out) const noexcept {
  format::row_parts parts;
  const bool good = db_->decode(cell, joined_.buffer, scratch_, parts) == row_outcome::good;
  out = parts.polygons;
  return good;
}

bool sightcell_view::previous_runs(std::span<const format::run>& out) const noexcept {
  if (!moved_ || previous_.everything || current_.everything) return false;
  out = previous_.runs();
  return true;
}
