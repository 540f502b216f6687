#include "stored_sets.h"

#include <algorithm>
#include <bit>

#include "range_borders.h"

namespace sightcell::format {
namespace {

// Calls use(source id) for the polygons of some draws in an order of all of them. Consecutive polygons mostly belong to
// the same draw.
template <class Use>
void for_each_source(std::span<const draw_record> draws, std::span<const std::uint32_t> order, const Use& use) {
  auto draw = draws.begin();
  for (const std::uint32_t place : order) {
    const std::uint32_t stored = draws.front().first_stored + place;
    if (stored < draw->first_stored || stored - draw->first_stored >= draw->polygon_count) {
      const auto begins_behind = [](std::uint32_t at, const draw_record& d) { return at < d.first_stored; };
      draw = std::upper_bound(draws.begin(), draws.end(), stored, begins_behind) - 1;
    }
    use(draw->first_source + (stored - draw->first_stored));
  }
}

}  // namespace

stored_sets::stored_sets(std::span<const draw_record> draws, std::span<const std::uint32_t> order_of_draw,
                         std::span<const std::vector<std::uint32_t>> orders, host_layout layout, std::uint32_t volumes,
                         std::span<const std::uint32_t> cluster_begins)
    : volumes_(volumes) {
  const std::uint32_t polygons = draws.empty() ? 0 : draws.back().first_stored + draws.back().polygon_count;
  stored_of_source_.resize(polygons);
  columns_ = cluster_begins.empty() ? polygons : static_cast<std::uint32_t>(cluster_begins.size());
  std::uint32_t stored = 0;
  std::uint32_t cluster = 0;  // clusters that begin up to here
  const auto next_column = [&] {
    if (cluster_begins.empty()) return stored++;
    if (cluster < cluster_begins.size() && cluster_begins[cluster] == stored) ++cluster;
    ++stored;
    return cluster - 1;
  };
  for (std::size_t begin = 0, end = 0; begin < draws.size(); begin = end) {
    for (end = begin + 1; end < draws.size() && !begins_range_unit(draws, end, layout);) ++end;
    for_each_source(draws.subspan(begin, end - begin), orders[order_of_draw[begin]],
                    [&](std::uint32_t source) { stored_of_source_[source] = next_column(); });
  }
}

// Uses a bit for each polygon: sorting the stored numbers takes several times as long.
void stored_sets::runs_of(std::span<const std::uint32_t> source_ids, std::vector<std::uint64_t>& members,
                          std::vector<run>& runs) const {
  runs.clear();
  members.resize((std::size_t{columns_} + volumes_) / 64 + 1);  // a bit for each polygon and volume and one after them
  for (const std::uint32_t id : source_ids) {
    const auto polygons = static_cast<std::uint32_t>(stored_of_source_.size());
    const std::uint32_t stored = id < polygons ? stored_of_source_[id] : id - polygons + columns_;
    members[stored / 64] |= std::uint64_t{1} << (stored % 64);
  }
  std::uint64_t before = 0;  // the bit of the polygon before the word
  for (std::size_t word = 0; word < members.size(); ++word) {
    const std::uint64_t bits = members[word];
    for (std::uint64_t left = bits ^ (bits << 1 | before); left != 0; left &= left - 1) {
      const auto border = static_cast<std::uint32_t>(64 * word) + static_cast<std::uint32_t>(std::countr_zero(left));
      if (runs.empty() || runs.back().count != 0) {
        runs.push_back({border, 0});
      } else {
        runs.back().count = border - runs.back().first;
      }
    }
    before = bits >> 63;
    members[word] = 0;
  }
}

}  // namespace sightcell::format
