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

// Adds up the classes of a set, which come in stored order, draw by draw: one class for each polygon of the set.
class angle_sums {
 public:
  angle_sums(const sightcell_view& view, std::span<const format::run> set, std::span<float> by_draw) noexcept
      : view_(view), borders_(view.db().range_borders()), set_(set), by_draw_(by_draw) {}

  void add(std::uint8_t one, std::uint32_t count) noexcept {
    while (count > 0) {
      const format::run& now = set_.front();
      const std::uint32_t stored = now.first + done_;
      while (borders_[draw_ + 1] <= stored) next_draw();
      const std::uint32_t some = std::min(std::min(count, now.count - done_), borders_[draw_ + 1] - stored);
      sum_ += static_cast<float>(some) * angle_of_class[one];
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
    if (sum_ > by_draw_[draw_] && !view_.is_hidden(draw_)) by_draw_[draw_] = sum_;
    sum_ = 0.0f;
    ++draw_;
  }

  const sightcell_view& view_;
  const std::span<const std::uint32_t> borders_;
  std::span<const format::run> set_;  // what is left
  std::uint32_t done_ = 0;            // polygons of its first run
  const std::span<float> by_draw_;
  std::uint32_t draw_ = 0;
  float sum_ = 0.0f;
};

sightcell_status add_cell(const sightcell_view& view, std::uint32_t cell, std::span<float> by_draw) noexcept {
  importance_classes classes;
  const sightcell_status opened = view.db().open_importance(cell, classes);
  if (opened != SIGHTCELL_OK) return opened;
  std::span<const format::run> set;
  if (!view.whole_set_of(cell, set)) return SIGHTCELL_ERR_CORRUPT;
  std::uint32_t polygons = 0;
  for (const format::run& r : set) polygons += r.count;
  angle_sums sums(view, set, by_draw);
  const importance_classes::class_sink add = [](void* user, std::uint8_t one, std::uint32_t count) noexcept {
    static_cast<angle_sums*>(user)->add(one, count);
  };
  const format::status read = classes.decode(cell, polygons, add, &sums);
  if (polygons > 0) sums.finish();
  return static_cast<sightcell_status>(read);
}

}  // namespace

sightcell_status write_draw_importance(const sightcell_view& view, std::span<float> by_draw) noexcept {
  std::fill(by_draw.begin(), by_draw.end(), 0.0f);
  if (!view.db().has_importance()) return SIGHTCELL_ERR_ABSENT;
  if (view.draws_all()) return SIGHTCELL_ERR_STALE;
  for (const std::uint32_t cell : view.shown_cells()) {
    if (const sightcell_status s = add_cell(view, cell, by_draw); s != SIGHTCELL_OK) {
      std::fill(by_draw.begin(), by_draw.end(), 0.0f);
      return s;
    }
  }
  return SIGHTCELL_OK;
}

}  // namespace sightcell::runtime
