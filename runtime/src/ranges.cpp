#include "ranges.h"

namespace sightcell::runtime {
namespace {

// Calls emit(run) for each run of a without b, ascending.
template <class Emit>
void for_each_missing(run_span a, run_span b, const Emit& emit) {
  std::size_t at = 0;
  for (const format::run& r : a) {
    std::uint32_t next = r.first;
    const std::uint32_t end = r.first + r.count;
    while (at < b.size() && b[at].first + b[at].count <= next) ++at;
    for (std::size_t i = at; i < b.size() && b[i].first < end; ++i) {
      if (b[i].first > next) emit(format::run{next, b[i].first - next});
      next = b[i].first + b[i].count;
    }
    if (next < end) emit(format::run{next, end - next});
  }
}

// Counts the ranges of a without b, and writes them unless dst is null. Searches for the draw of each run from the draw
// in which the one before ended.
std::uint64_t list_difference(run_span a, run_span b, range_borders borders, sightcell_range* dst) noexcept {
  std::uint64_t ranges = 0;
  std::uint32_t draw = 0;
  for_each_missing(a, b, [&](const format::run& r) {
    const std::uint32_t from = draw;
    for_each_range(run_span(&r, 1), borders.subspan(from), [&](std::uint32_t d, std::uint32_t first, std::uint32_t n) {
      draw = from + d;
      if (dst != nullptr) *dst++ = {draw, first, n};
      ++ranges;
    });
  });
  return ranges;
}

}  // namespace

std::size_t write_ranges(run_span set, range_borders borders, std::span<sightcell_range> dst) noexcept {
  std::size_t ranges = 0;
  for_each_range(set, borders, [&](std::uint32_t draw, std::uint32_t first, std::uint32_t count) {
    if (ranges < dst.size()) dst[ranges] = {draw, first, count};
    ++ranges;
  });
  return ranges;
}

std::uint64_t count_difference(run_span a, run_span b, range_borders borders) noexcept {
  return list_difference(a, b, borders, nullptr);
}

void write_difference(run_span a, run_span b, range_borders borders, sightcell_range* dst) noexcept {
  static_cast<void>(list_difference(a, b, borders, dst));
}

std::size_t write_difference(run_span a, run_span b, std::span<format::run> dst) noexcept {
  std::size_t runs = 0;
  for_each_missing(a, b, [&](const format::run& r) {
    if (runs < dst.size()) dst[runs] = r;
    ++runs;
  });
  return runs;
}

}  // namespace sightcell::runtime
