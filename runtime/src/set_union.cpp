#include "set_union.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace sightcell::runtime {
namespace {

// Calls emit(run) for each run of the union, ascending, not touching.
template <class Emit>
void for_each_of_both(run_span a, run_span b, const Emit& emit) {
  std::size_t i = 0;
  std::size_t j = 0;
  const auto next = [&] { return j == b.size() || (i < a.size() && a[i].first < b[j].first) ? a[i++] : b[j++]; };
  while (i < a.size() || j < b.size()) {
    format::run held = next();
    while ((i < a.size() && a[i].first <= held.first + held.count) ||
           (j < b.size() && b[j].first <= held.first + held.count)) {
      const format::run more = next();
      held.count = std::max(held.count, more.first + more.count - held.first);
    }
    emit(held);
  }
}

// Closes gaps of fewer than min_gap polygons between two runs in one draw. Returns whether out has room for the runs
// and there are at most most_ranges ranges.
bool write_closed(run_span a, run_span b, range_borders borders, std::uint32_t min_gap, std::uint64_t most_ranges,
                  std::span<format::run> out, std::size_t& count) noexcept {
  std::size_t runs = 0;
  std::uint64_t ranges = 0;
  std::size_t draw = 0;
  std::uint32_t draw_end = 0;  // end of the draw in which the last run ends
  for_each_of_both(a, b, [&](const format::run& r) {
    const std::uint32_t end = r.first + r.count;
    const bool close = runs > 0 && runs <= out.size() && r.first < draw_end &&
                       r.first - (out[runs - 1].first + out[runs - 1].count) < min_gap;
    std::uint32_t borders_passed = 0;
    while (draw_end < end) {
      const std::uint32_t border = std::exchange(draw_end, borders[++draw]);
      borders_passed += border > r.first && draw_end > border ? 1 : 0;  // not those of draws without polygons
    }
    if (close) {
      out[runs - 1].count = end - out[runs - 1].first;
    } else {
      if (runs < out.size()) out[runs] = r;
      ++runs;
      ++ranges;
    }
    ranges += borders_passed;
  });
  count = runs;
  return runs <= out.size() && ranges <= most_ranges;
}

}  // namespace

bool write_union(run_span a, run_span b, range_borders borders, std::uint32_t most_ranges, std::span<format::run> out,
                 std::size_t& count) noexcept {
  constexpr std::uint32_t all = std::numeric_limits<std::uint32_t>::max();
  for (std::uint32_t min_gap = 1;; min_gap = min_gap > all / 2 ? all : 2 * min_gap) {
    if (write_closed(a, b, borders, min_gap, most_ranges, out, count)) return true;
    if (min_gap == all) return false;
  }
}

}  // namespace sightcell::runtime
