#include "chunk_encoder.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "row_encoder.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Polygons of a set per stretch of the scene. The sum of differences between two of these is a lower bound of the
// number of polygons in which the sets differ: cheap enough to look at every pair, good enough to pick the pairs worth
// coding.
constexpr std::size_t bucket_count = 256;
using histogram = std::array<std::uint32_t, bucket_count>;
constexpr std::size_t candidates_per_cell = 12;
constexpr std::uint32_t no_cell = 0xFFFFFFFFu;

struct edge {
  std::size_t saving = 0;  // bytes
  std::uint32_t cell = 0;
  std::uint32_t reference = 0;
};

histogram make_histogram(std::span<const run> set, std::uint32_t polygon_count) {
  histogram h{};
  const std::uint64_t width = std::uint64_t{polygon_count} / bucket_count + 1;
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

// First cell of the chunk with the same set, itself included.
std::vector<std::uint32_t> first_equal(std::span<const std::vector<run>> sets) {
  std::vector<std::uint32_t> first(sets.size());
  for (std::uint32_t cell = 0; cell < sets.size(); ++cell) {
    first[cell] = cell;
    for (std::uint32_t other = 0; other < cell && first[cell] == cell; ++other) {
      if (equal(sets[other], sets[cell])) first[cell] = other;
    }
  }
  return first;
}

// Every difference between like cells that is smaller than the cell's own runs, largest saving first.
std::vector<edge> saving_edges(std::span<const std::vector<run>> sets, std::span<const std::uint32_t> first,
                               std::uint32_t polygon_count) {
  std::vector<histogram> histograms;
  histograms.reserve(sets.size());
  for (const auto& set : sets) histograms.push_back(make_histogram(set, polygon_count));
  std::vector<edge> edges;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> near;
  std::vector<run> removed;
  std::vector<run> added;
  for (std::uint32_t cell = 0; cell < sets.size(); ++cell) {
    if (first[cell] != cell) continue;
    near.clear();
    for (std::uint32_t other = 0; other < sets.size(); ++other) {
      if (other != cell && first[other] == other) {
        near.emplace_back(distance(histograms[cell], histograms[other]), other);
      }
    }
    std::sort(near.begin(), near.end());
    near.resize(std::min(near.size(), candidates_per_cell));
    const std::size_t own = own_row_size(sets[cell]);
    for (const auto& [unused, other] : near) {
      difference(sets[other], sets[cell], removed, added);
      const std::size_t size = delta_row_size(removed, added);
      if (size < own) edges.push_back({own - size, cell, other});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const edge& a, const edge& b) {
    return std::tie(b.saving, a.cell, a.reference) < std::tie(a.saving, b.cell, b.reference);
  });
  return edges;
}

// Takes edges greedily while no chain of references gets longer than the format allows or bites its tail.
std::vector<std::uint32_t> choose_references(std::size_t cells, std::span<const edge> edges) {
  std::vector<std::uint32_t> reference(cells, no_cell);
  std::vector<std::uint32_t> depth(cells, 0);   // references above a cell
  std::vector<std::uint32_t> height(cells, 0);  // longest chain that stands on a cell
  for (const edge& e : edges) {
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

}  // namespace

encoded_chunk encode_chunk(std::span<const std::vector<run>> sets, std::uint32_t polygon_count) {
  const std::vector<std::uint32_t> first = first_equal(sets);
  const std::vector<edge> edges = saving_edges(sets, first, polygon_count);
  const std::vector<std::uint32_t> reference = choose_references(sets.size(), edges);
  encoded_chunk chunk;
  std::vector<run> removed;
  std::vector<run> added;
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    if (first[cell] != cell) {
      chunk.rows.push_back(chunk.rows[first[cell]]);
      continue;
    }
    const std::uint64_t offset = chunk.bytes.size();
    if (reference[cell] == no_cell) {
      encode_own_row(sets[cell], chunk.bytes);
    } else {
      difference(sets[reference[cell]], sets[cell], removed, added);
      encode_delta_row(reference[cell], removed, added, chunk.bytes);
    }
    chunk.rows.push_back({offset, chunk.bytes.size() - offset});
  }
  return chunk;
}

}  // namespace sightcell::format
