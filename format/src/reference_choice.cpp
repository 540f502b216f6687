#include "reference_choice.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Members of a set per interval of the numbers. The sum of the differences between two of these is a lower bound of the
// number of members in which the sets differ.
constexpr std::size_t bucket_count = 256;
using histogram = std::array<std::uint32_t, bucket_count>;

histogram make_histogram(std::span<const run> set, std::uint32_t limit) {
  histogram h{};
  const std::uint64_t width = std::uint64_t{limit} / bucket_count + 1;
  for (const run& r : set) {
    const std::uint64_t end = std::uint64_t{r.first} + r.count;
    for (std::uint64_t place = r.first; place < end;) {
      const std::uint64_t bucket = place / width;
      const std::uint64_t stop = std::min(end, (bucket + 1) * width);
      h[bucket] += static_cast<std::uint32_t>(stop - place);
      place = stop;
    }
  }
  return h;
}

std::uint64_t distance(const histogram& a, const histogram& b) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < bucket_count; ++i) sum += a[i] > b[i] ? a[i] - b[i] : b[i] - a[i];
  return sum;
}

bool equal(std::span<const run> a, std::span<const run> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const run& x, const run& y) { return x.first == y.first && x.count == y.count; });
}

}  // namespace

std::vector<std::uint32_t> first_equal(std::span<const std::vector<run>> sets) {
  std::vector<std::uint32_t> first(sets.size());
  for (std::uint32_t cell = 0; cell < sets.size(); ++cell) {
    while (first[cell] < cell && !equal(sets[first[cell]], sets[cell])) ++first[cell];
  }
  return first;
}

std::vector<std::vector<std::uint32_t>> likely_references(std::span<const std::vector<run>> sets,
                                                          std::span<const std::uint32_t> first, std::uint32_t limit,
                                                          std::size_t count) {
  std::vector<histogram> histograms;
  histograms.reserve(sets.size());
  for (const auto& set : sets) histograms.push_back(make_histogram(set, limit));
  std::vector<std::vector<std::uint32_t>> likely(sets.size());
  std::vector<std::pair<std::uint64_t, std::uint32_t>> near;
  for (std::uint32_t cell = 0; cell < sets.size(); ++cell) {
    if (first[cell] != cell) continue;
    near.clear();
    for (std::uint32_t other = 0; other < sets.size(); ++other) {
      if (other != cell && first[other] == other) {
        near.emplace_back(distance(histograms[cell], histograms[other]), other);
      }
    }
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), count));
    for (const auto& [unused, other] : near) likely[cell].push_back(other);
  }
  return likely;
}

std::vector<std::uint32_t> choose_references(std::size_t cells, std::vector<saving_difference> differences) {
  std::sort(differences.begin(), differences.end(), [](const saving_difference& a, const saving_difference& b) {
    return std::tie(b.saving, a.cell, a.reference) < std::tie(a.saving, b.cell, b.reference);
  });
  std::vector<std::uint32_t> reference(cells, no_cell);
  std::vector<std::uint32_t> depth(cells, 0);   // references above a cell
  std::vector<std::uint32_t> height(cells, 0);  // longest chain of references to a cell
  for (const saving_difference& e : differences) {
    if (reference[e.cell] != no_cell || depth[e.reference] + 1 + height[e.cell] > layout::max_reference_depth) continue;
    bool loop = false;
    for (std::uint32_t at = e.reference; at != no_cell; at = reference[at]) loop = loop || at == e.cell;
    if (loop) continue;
    reference[e.cell] = e.reference;
    std::uint32_t tall = height[e.cell];
    for (std::uint32_t at = e.reference; at != no_cell; at = reference[at]) height[at] = std::max(height[at], ++tall);
    for (std::size_t cell = 0; cell < cells; ++cell) {
      std::uint32_t steps = 0;
      for (std::uint32_t at = reference[cell]; at != no_cell; at = reference[at]) ++steps;
      depth[cell] = steps;
    }
  }
  return reference;
}

}  // namespace sightcell::format
