#include "job/timed_progress.h"

#include <algorithm>

namespace sightcell::bake {

timed_progress::timed_progress(std::uint32_t polygon_count, std::size_t cells, double last_target,
                               const time_budget& clock, const callbacks& events)
    : polygon_count_(polygon_count), last_target_(last_target), clock_(clock), events_(events), cells_(cells) {}

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
  return report_progress();
}

bool timed_progress::close(std::span<const stage_record> records, checkpoint& done) {
  done.store(records);
  const bool in_time = !clock_.over();
  for (const stage_record& one : records) {
    take(one.cell, summary_of(one.record));
    cells_[one.cell].gave_up = in_time && target_ <= last_target_ && cells_[one.cell].bound > last_target_;
    ++turns_;
  }
  return report_progress() && in_time;
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

bool timed_progress::report_progress() {
  if (!events_.on_progress || stopped_) return !stopped_;
  progress now;
  now.cells_total = static_cast<std::uint32_t>(cells_.size());
  now.target = target_;
  now.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
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
  stopped_ = true;  // stays true if the callback throws
  stopped_ = !events_.on_progress(now);
  return !stopped_;
}

}  // namespace sightcell::bake
