#include "job/progress_tracker.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

namespace sightcell::bake {
namespace {

// About the part of a cell's time that its stages take, for the estimate of the time that is left.
constexpr double sampling_share = 0.2, check_share = 0.2;

}  // namespace

progress_tracker::progress_tracker(tracked_cells tracked, const stage_plan& plan, const callbacks& events)
    : tracked_(std::move(tracked)),
      plan_(plan),
      events_(events),
      have_(plan.blocks().cell_count()),
      counted_(plan.blocks().cell_count()),
      sizes_(plan.blocks().cell_count()),
      work_of_(plan.blocks().cell_count()),
      seconds_of_(plan.blocks().cell_count()),
      began_(tracked_.now()) {
  now_.phase = bake_phase::estimating;
  now_.cells_total = tracked_.total;
}

// Returns the part of a cell's work that is done with this stage.
double progress_tracker::work_until(cell_stage stage) {
  if (stage == cell_stage::finished) return 1.0;
  return stage == cell_stage::bounded ? 1.0 - check_share : sampling_share;
}

void progress_tracker::count(std::uint32_t cell, cell_stage stage, const cell_summary& record) {
  have_.add(cell, stage);
  const double done = std::max(work_until(stage), work_of_[cell]);
  work_done_ += done - work_of_[cell];
  work_of_[cell] = done;
  if (stage == cell_stage::finished) ++now_.cells_checked;
  if (stage == cell_stage::sampled || !record.stored) {
    if (stage != cell_stage::sampled && !counted_[cell]) ++now_.cells_done, counted_[cell] = true;
    return;
  }
  if (!counted_[cell]) {
    counted_[cell] = true;
    ++now_.cells_done;
    ++stored_;
    rays_ += record.rays;
    misses_ += record.misses;
    now_.pixel_error = rays_ > 0 ? static_cast<double>(misses_) / static_cast<double>(rays_) : 0.0;
    now_.worst_bound = std::max(now_.worst_bound, record.rays > 0 ? record.upper_bound : 0.0);
    if (events_.on_progress) {
      const view_cell& box = tracked_.cells[cell];
      bounded_.push_back({.cell = cell,
                          .min = {box.min.x, box.min.y, box.min.z},
                          .max = {box.max.x, box.max.y, box.max.z},
                          .polygons = record.polygons,
                          .bound = record.rays > 0 ? record.upper_bound : 1.0,
                          .seconds = std::max(-1.0f, seconds_of_[cell])});
    }
  }
  const auto size = static_cast<std::uint32_t>(std::max<std::uint64_t>(record.polygons, sizes_[cell]));
  visible_ += 100.0 * (size - sizes_[cell]) / std::max(tracked_.polygon_count, 1u);
  sizes_[cell] = size;
  now_.visible_percent = visible_ / stored_;
}

void progress_tracker::resume(std::uint32_t cell, cell_stage stage, const cell_summary& record) {
  if (cell >= counted_.size()) return;  // a broken file
  seconds_of_[cell] = -std::numeric_limits<float>::infinity();
  count(cell, stage, record);
  resumed_ = now_.cells_done;
}

bool progress_tracker::open() {
  began_ = tracked_.now();
  return report_progress({});
}

void progress_tracker::begin(bake_phase phase) {
  if (now_.phase == phase) return;
  now_.phase = phase;
  if (events_.on_phase) events_.on_phase(phase);
}

bool progress_tracker::preparing(double share) {
  now_.prepared = share;
  const bool proceed = report_progress({});
  now_.prepared = 1.0;
  return proceed;
}

// Finds records of the first round that no step reads anymore: those of blocks with all cells through phase 1.
void progress_tracker::forget_first_rounds(std::span<const stage_record> records,
                                           std::vector<std::uint32_t>& forget) const {
  std::vector<std::uint32_t> blocks;
  for (const stage_record& one : records)
    if (one.stage == cell_stage::bounded && plan_.shares_in_block(one.cell))
      blocks.push_back(plan_.blocks().block_of(one.cell));
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  for (const std::uint32_t block : blocks) {
    const std::span<const std::uint32_t> cells = plan_.blocks().cells_of(block);
    const auto through = [&](std::uint32_t cell) {
      return plan_.through_phase_1(have_, cell) ||
             std::any_of(records.begin(), records.end(), [&](const stage_record& one) {
               return one.cell == cell && one.stage == plan_.end_of_phase_1(cell);
             });
    };
    if (!std::all_of(cells.begin(), cells.end(), through)) continue;
    for (const std::uint32_t cell : cells)
      if (have_.has(cell, cell_stage::sampled)) forget.push_back(cell);
  }
}

bool progress_tracker::close(std::span<const stage_record> records, std::span<const step_in_work> in_work,
                             checkpoint& done) {
  if (records.empty()) return report_progress(in_work);
  std::vector<std::uint32_t> forget;
  forget_first_rounds(records, forget);
  done.store(records, forget);
  for (const std::uint32_t cell : forget) have_.remove(cell, cell_stage::sampled);
  for (const stage_record& one : records) {
    const std::uint32_t before = now_.cells_done;
    const double work_before = work_done_;
    seconds_of_[one.cell] += static_cast<float>(one.seconds);
    count(one.cell, one.stage, summary_of(one.record));
    fresh_work_ += work_done_ - work_before;
    if (one.stage != cell_stage::sampled && now_.cells_done > before) not_empty_ += one.record.geometry_inside ? 1 : 0;
  }
  return report_progress(in_work);
}

cell_times progress_tracker::times() const {
  std::vector<std::pair<float, std::uint32_t>> all;
  for (std::uint32_t cell = 0; cell < seconds_of_.size(); ++cell)
    if (work_of_[cell] >= 1.0 && seconds_of_[cell] >= 0.0f) all.emplace_back(seconds_of_[cell], cell);
  if (all.empty()) return {};
  const auto center_of = [&](std::uint32_t cell) {
    const glm::vec3 center = 0.5f * (tracked_.cells[cell].min + tracked_.cells[cell].max);
    return std::array<float, 3>{center.x, center.y, center.z};
  };
  std::vector<timed_cell> each;
  for (const auto& [seconds, cell] : all) each.push_back({center_of(cell), seconds});
  std::sort(all.begin(), all.end());
  return {.cells = static_cast<std::uint32_t>(all.size()),
          .median = all[all.size() / 2].first,
          .percentile_99 = all[(all.size() * 99 + 99) / 100 - 1].first,
          .longest = all.back().first,
          .center = center_of(all.back().second),
          .each = std::move(each)};
}

void progress_tracker::estimate_time(std::size_t in_work) {
  now_.seconds = std::chrono::duration<double>(tracked_.now() - began_).count();
  if (fresh_work_ > 0.0) {
    // Steps in work are half done on average, and a step is about half of a cell.
    const double ahead = 0.25 * static_cast<double>(in_work);
    now_.cells_per_second = (fresh_work_ + ahead) / std::max(now_.seconds, 1e-9);
    now_.seconds_left = std::max(now_.cells_total - work_done_ - ahead, 0.0) / now_.cells_per_second;
    return;
  }
  // The cells that have not begun take their share of the estimate, however long the first ones take.
  const double left = std::max(now_.cells_total - work_done_, 1.0);
  const double not_begun = std::max(left - static_cast<double>(in_work), 0.0) / left;
  now_.seconds_left = std::max(expected_ - now_.seconds, expected_ * not_begun);
}

bool progress_tracker::report_progress(std::span<const step_in_work> in_work) {
  if (stopped_) report_stopping(in_work);
  if (!events_.on_progress || stopped_) return !stopped_;
  estimate_time(in_work.size());
  now_.cells_in_work = static_cast<std::uint32_t>(in_work.size());
  now_.slow = longest_in_work(in_work, tracked_.cells, tracked_.now(), slow_seconds);
  const bool bounded = now_.cells_done == now_.cells_total;
  const bool all = tracked_.last_phase == 1 ? bounded : now_.cells_checked == now_.cells_total;
  if (bounded && !all && now_.phase == bake_phase::baking_cells) begin(bake_phase::checking_neighbors);
  if (all) now_.seconds_left = 0.0;  // without the rest that rounding leaves
  now_.bounded = bounded_;
  stopped_ = true;  // stays true if the callback throws
  stopped_ = canceled_ = !events_.on_progress(now_) && !all;
  now_.bounded = {};
  bounded_.clear();
  return !stopped_;
}

void progress_tracker::report_stopping(std::span<const step_in_work> in_work) {
  if (!canceled_ || !events_.on_stopping || in_work.empty()) return;
  now_.seconds = std::chrono::duration<double>(tracked_.now() - began_).count();
  now_.cells_in_work = static_cast<std::uint32_t>(in_work.size());
  now_.slow = longest_in_work(in_work, tracked_.cells, tracked_.now(), 0.0);
  canceled_ = false;  // stays false if the callback throws
  events_.on_stopping(now_);
  canceled_ = true;
}

}  // namespace sightcell::bake
