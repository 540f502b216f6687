#include "draw_importance.h"

#include <algorithm>
#include <array>

#include "sightcell/format/importance_classes.h"

namespace sightcell::runtime {
namespace {

using format::importance_classes;

constexpr auto angle_of_class = [] {
  std::array<float, format::importance_class_count> angles{};
  for (std::uint8_t k = 0; k < angles.size(); ++k) angles[k] = format::solid_angle_of_class(k);
  return angles;
}();

// Adds up the classes of a set, which come in stored order, draw by draw.
class angle_sums {
 public:
  angle_sums(std::span<const format::run> set, std::span<const std::uint32_t> borders,
             std::span<float> by_draw) noexcept
      : set_(set), borders_(borders), by_draw_(by_draw) {}

  void add(std::uint8_t one, std::uint32_t count) noexcept {
    while (count > 0 && !set_.empty()) {
      const format::run& now = set_.front();
      const std::uint32_t stored = now.first + done_;
      while (borders_[draw_ + 1] <= stored) next_draw();
      const std::uint32_t some = std::min({count, now.count - done_, borders_[draw_ + 1] - stored});
      sum_ += static_cast<double>(some) * static_cast<double>(angle_of_class[one]);
      count -= some;
      done_ += some;
      if (done_ < now.count) continue;
      set_ = set_.subspan(1);
      done_ = 0;
    }
  }

  void finish() noexcept { next_draw(); }

 private:
  void next_draw() noexcept {
    if (sum_ > 0.0) by_draw_[draw_] = std::max(by_draw_[draw_], static_cast<float>(sum_));
    sum_ = 0.0;
    ++draw_;
  }

  std::span<const format::run> set_;
  std::uint32_t done_ = 0;  // polygons of the first run
  std::span<const std::uint32_t> borders_;
  std::span<float> by_draw_;
  std::size_t draw_ = 0;
  double sum_ = 0.0;
};

sightcell_status add_cell(const sightcell_view& view, std::uint32_t cell, std::span<float> by_draw) noexcept {
  const importance_classes* classes = nullptr;
  const sightcell_status found = view.db().importance_of(cell, classes);
  if (found != SIGHTCELL_OK) return found;
  std::span<const format::run> set;
  if (!view.whole_set_of(cell, set)) return SIGHTCELL_ERR_CORRUPT;
  std::uint32_t polygons = 0;
  for (const format::run& r : set) polygons += r.count;
  angle_sums sums(set, view.db().range_borders(), by_draw);
  const importance_classes::class_sink add = [](void* user, std::uint8_t one, std::uint32_t count) noexcept {
    static_cast<angle_sums*>(user)->add(one, count);
  };
  const format::status read = classes->decode(cell, polygons, add, &sums);
  if (polygons > 0) sums.finish();
  return static_cast<sightcell_status>(read);
}

}  // namespace

sightcell_status write_draw_importance(const sightcell_view& view, std::span<float> by_draw) noexcept {
  std::fill(by_draw.begin(), by_draw.end(), 0.0f);
  sightcell_status outcome = view.draws_all() ? SIGHTCELL_ERR_STALE : SIGHTCELL_OK;
  if (!view.db().has_importance()) outcome = SIGHTCELL_ERR_ABSENT;
  for (const std::uint32_t cell : view.shown_cells())
    if (outcome == SIGHTCELL_OK) outcome = add_cell(view, cell, by_draw);
  if (outcome != SIGHTCELL_OK) {
    std::fill(by_draw.begin(), by_draw.end(), 0.0f);
    return outcome;
  }
  for (std::uint32_t draw = 0; draw < by_draw.size(); ++draw)
    if (view.is_hidden(draw)) by_draw[draw] = 0.0f;
  return SIGHTCELL_OK;
}

}  // namespace sightcell::runtime
