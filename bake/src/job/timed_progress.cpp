#include "job/timed_progress.h"

#include <algorithm>
#include <chrono>

namespace sightcell::bake {

timed_progress::timed_progress(std::uint32_t polygon_count, std::span<const view_cell> cells, double last_target,
                               const time_budget& clock, const callbacks& events)
    : polygon_count_(polygon_count),
      last_target_(last_target),
      clock_(clock),
      events_(events),
      boxes_(cells),
      cells_(cells.size()) {}

void timed_progress::take(std::uint32_t cell, const cell_summary& record) {
  cells_[cell] = {record.upper_bound, record.rays, record.misses, record.polygons, record.stored, false};
}

void timed_progress::resume(std::uint32_t cell, const cell_summary& record) {
  if (cell >= cells_.size()) return;  // a broken file
  take(cell, record);
  if (!record.stored || record.upper_bound < 1.0) ++resumed_;
}

bool timed_progress::open(double target) {
  target_ = target;
  return report_progress({});
}

void timed_progress::begin(bake_phase phase) {
  if (phase_ == phase) return;
  phase_ = phase;
  if (events_.on_phase) events_.on_phase(phase);
}

bool timed_progress::close(std::span<const stage_record> records, std::span<const step_in_work> in_work,
                           checkpoint& done) {
  if (!records.empty()) done.store(records);
  const bool in_time = !clock_.over();
  for (const stage_record& one : records) {
    take(one.cell, summary_of(one.record));
    cells_[one.cell].gave_up = in_time && target_ <= last_target_ && cells_[one.cell].bound > last_target_;
    ++turns_;
  }
  return report_progress(in_work) && in_time;
}

std::vector<std::uint32_t> timed_progress::above(double target) const {
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < cells_.size(); ++cell)
    if (cells_[cell].stored && cells_[cell].bound > target) cells.push_back(cell);
  std::stable_sort(cells.begin(), cells.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return cells_[a].bound > cells_[b].bound; });
  return cells;
}

std::vector<std::uint32_t> timed_progress::known() const {
  std::vector<std::uint32_t> cells;
  for (std::uint32_t cell = 0; cell < cells_.size(); ++cell)
    if (cells_[cell].bounded() || !cells_[cell].stored) cells.push_back(cell);
  return cells;
}

template <typename Is>
std::uint32_t timed_progress::count(Is is) const {
  return static_cast<std::uint32_t>(std::count_if(cells_.begin(), cells_.end(), is));
}

std::uint32_t timed_progress::bounded() const {
  return count([](const cell_state& one) { return one.bounded(); });
}

std::uint32_t timed_progress::unreached() const {
  return count([](const cell_state& one) { return one.stored && !one.bounded(); });
}

std::uint32_t timed_progress::out_of_rays() const {
  return count([](const cell_state& one) { return one.bounded() && one.gave_up; });
}

progress timed_progress::now() const {
  progress now;
  now.phase = phase_;
  now.cells_total = static_cast<std::uint32_t>(cells_.size());
  now.target = target_;
  now.seconds = std::chrono::duration<double>(work_clock::now() - began_).count();
  now.seconds_left = std::max(clock_.left(), 0.0);
  now.cells_per_second = turns_ / std::max(now.seconds, 1e-9);
  std::uint64_t rays = 0, misses = 0;
  double polygons = 0.0;
  std::uint32_t stored = 0;
  for (const cell_state& one : cells_) {
    if (one.bounded() || !one.stored) ++now.cells_done;
    if (one.bound <= last_target_ || !one.stored) ++now.cells_checked;
    if (!one.bounded()) continue;
    ++stored;
    rays += one.rays;
    misses += one.misses;
    polygons += static_cast<double>(one.polygons);
    now.worst_bound = std::max(now.worst_bound, one.bound);
  }
  now.pixel_error = rays > 0 ? static_cast<double>(misses) / static_cast<double>(rays) : 0.0;
  now.visible_percent = 100.0 * polygons / (std::max(stored, 1u) * static_cast<double>(std::max(polygon_count_, 1u)));
  return now;
}

bool timed_progress::report_progress(std::span<const step_in_work> in_work) {
  if (stopped_) report_stopping(in_work);
  if (!events_.on_progress || stopped_) return !stopped_;
  progress state = now();
  state.cells_in_work = static_cast<std::uint32_t>(in_work.size());
  state.slow = longest_in_work(in_work, boxes_, work_clock::now(), slow_seconds);
  stopped_ = true;  // stays true if the callback throws
  stopped_ = canceled_ = !events_.on_progress(state);
  return !stopped_;
}

void timed_progress::report_stopping(std::span<const step_in_work> in_work) {
  if (!canceled_ || !events_.on_stopping || in_work.empty()) return;
  progress state = now();
  state.cells_in_work = static_cast<std::uint32_t>(in_work.size());
  state.slow = longest_in_work(in_work, boxes_, work_clock::now(), 0.0);
  canceled_ = false;  // stays false if the callback throws
  events_.on_stopping(state);
  canceled_ = true;
}

}  // namespace sightcell::bake
