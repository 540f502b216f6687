#include "row_chunk_encoder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>
#include <utility>

#include "bit_reader.h"
#include "bit_sink.h"
#include "rank_encoder.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Numbers of a set per stretch of all numbers. The sum of differences between two of these is a lower bound of the
// number of members in which the sets differ: cheap enough to look at every pair, good enough to pick the pairs worth
// coding.
constexpr std::size_t bucket_count = 256;
using histogram = std::array<std::uint32_t, bucket_count>;
constexpr std::size_t candidates_per_cell = 16;
// Bits of a difference besides its lists, about: reference and two counts.
constexpr std::uint64_t delta_head_bits = 30;
constexpr std::uint64_t own_head_bits = 16;

struct edge {
  std::uint64_t saving = 0;  // bits
  std::uint32_t cell = 0;
  std::uint32_t reference = 0;
};

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

std::vector<std::uint8_t> first_equal(std::span<const std::vector<run>> sets) {
  std::vector<std::uint8_t> same(sets.size());
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    std::size_t first = 0;
    while (first < cell && !equal(sets[first], sets[cell])) ++first;
    same[cell] = static_cast<std::uint8_t>(first);
  }
  return same;
}

// The cells that are likely to be the best references of one.
std::vector<std::uint32_t> candidates_of(std::uint32_t cell, std::span<const histogram> histograms,
                                         std::span<const std::uint8_t> same) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> near;
  for (std::uint32_t other = 0; other < histograms.size(); ++other) {
    if (other != cell && same[other] == other) {
      near.emplace_back(distance(histograms[cell], histograms[other]), other);
    }
  }
  const std::size_t count = std::min(near.size(), candidates_per_cell);
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  std::vector<std::uint32_t> chosen;
  for (std::size_t i = 0; i < count; ++i) chosen.push_back(near[i].second);
  return chosen;
}

// Every difference between like cells that is worth it, largest saving first.
std::vector<edge> saving_edges(std::span<const std::vector<run>> sets, std::span<const std::uint8_t> same,
                               const row_encoders& encoders, std::uint32_t limit) {
  std::vector<histogram> histograms;
  histograms.reserve(sets.size());
  for (const auto& set : sets) histograms.push_back(make_histogram(set, limit));
  std::vector<edge> edges;
  std::vector<run> removed;
  std::vector<run> added;
  for (std::uint32_t cell = 0; cell < sets.size(); ++cell) {
    if (same[cell] != cell) continue;
    const std::uint64_t own = own_head_bits + encoders.own.size(sets[cell]);
    for (const std::uint32_t other : candidates_of(cell, histograms, same)) {
      make_rank_difference(sets[other], sets[cell], removed, added);
      const std::uint64_t delta = delta_head_bits + encoders.removed.size(removed) + encoders.added.size(added);
      if (delta < own - own / 8) edges.push_back({own - delta, cell, other});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const edge& a, const edge& b) {
    return std::tie(b.saving, a.cell, a.reference) < std::tie(a.saving, b.cell, b.reference);
  });
  return edges;
}

// References above each cell.
std::vector<std::uint32_t> depths_of(std::span<const std::uint8_t> reference) {
  std::vector<std::uint32_t> depth(reference.size(), 0);
  for (std::size_t cell = 0; cell < reference.size(); ++cell) {
    for (std::uint8_t at = reference[cell]; at != chunk_plan::alone; at = reference[at]) ++depth[cell];
  }
  return depth;
}

bool stands_on(std::span<const std::uint8_t> reference, std::uint32_t cell, std::uint32_t other) {
  for (auto at = static_cast<std::uint8_t>(cell); at != chunk_plan::alone; at = reference[at]) {
    if (at == other) return true;
  }
  return false;
}

// Takes edges greedily while no chain of references gets longer than the format allows or bites its tail.
std::vector<std::uint8_t> choose_references(std::size_t cells, std::span<const edge> edges) {
  std::vector<std::uint8_t> reference(cells, chunk_plan::alone);
  for (const edge& e : edges) {
    if (reference[e.cell] != chunk_plan::alone || stands_on(reference, e.reference, e.cell)) continue;
    reference[e.cell] = static_cast<std::uint8_t>(e.reference);
    const auto depth = depths_of(reference);
    if (*std::max_element(depth.begin(), depth.end()) > layout::max_reference_depth) {
      reference[e.cell] = chunk_plan::alone;
    }
  }
  return reference;
}

void put_count(std::size_t count, bit_sink& out) {
  const auto value = static_cast<std::uint32_t>(count);
  const auto bits = static_cast<unsigned>(std::bit_width(value));
  out.put(bits, 5);
  if (bits > 0) out.put(value, bits - 1);
}

}  // namespace

chunk_plan plan_chunk(std::span<const std::vector<run>> sets, const row_encoders& encoders, std::uint32_t limit) {
  chunk_plan plan;
  plan.same = first_equal(sets);
  plan.reference = choose_references(sets.size(), saving_edges(sets, plan.same, encoders, limit));
  return plan;
}

void count_chunk(std::span<const std::vector<run>> sets, const chunk_plan& plan, row_counts& counts) {
  std::vector<run> removed;
  std::vector<run> added;
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    if (plan.same[cell] != cell) continue;
    if (plan.reference[cell] == chunk_plan::alone) {
      counts.own.add(sets[cell]);
      continue;
    }
    make_rank_difference(sets[plan.reference[cell]], sets[cell], removed, added);
    counts.removed.add(removed);
    counts.added.add(added);
    const std::size_t longest = std::max(removed.size(), added.size());
    counts.list_runs = std::max(counts.list_runs, static_cast<std::uint32_t>(longest));
  }
}

void encode_chunk(std::span<const std::vector<run>> sets, const chunk_plan& plan, const row_encoders& encoders,
                  std::vector<std::byte>& out) {
  std::vector<std::byte> rows;
  bit_sink bits(rows);
  std::vector<std::uint32_t> begin(sets.size());
  std::vector<run> removed;
  std::vector<run> added;
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    begin[cell] = plan.same[cell] == cell ? static_cast<std::uint32_t>(rows.size()) : begin[plan.same[cell]];
    if (plan.same[cell] != cell) continue;
    const bool delta = plan.reference[cell] != chunk_plan::alone;
    bits.put(delta ? 1 : 0, 1);
    if (delta) {
      make_rank_difference(sets[plan.reference[cell]], sets[cell], removed, added);
      bits.put(plan.reference[cell], 6);
      put_count(removed.size(), bits);
      put_count(added.size(), bits);
      encoders.removed.encode(removed, bits);
      encoders.added.encode(added, bits);
    } else {
      put_count(sets[cell].size(), bits);
      encoders.own.encode(sets[cell], bits);
    }
    bits.align();
  }
  const auto width = static_cast<unsigned>(std::bit_width(*std::max_element(begin.begin(), begin.end())));
  bit_sink table(out);
  table.put(width, 8);
  for (const std::uint32_t place : begin) table.put(place, width);
  table.align();
  out.insert(out.end(), rows.begin(), rows.end());
  out.insert(out.end(), bit_reader::padding, std::byte{0});
}

}  // namespace sightcell::format
