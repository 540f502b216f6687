#include "row_chunk_encoder.h"

#include <algorithm>
#include <bit>

#include "bit_reader.h"
#include "bit_sink.h"
#include "rank_encoder.h"
#include "reference_choice.h"

namespace sightcell::format {
namespace {

constexpr std::size_t candidates_per_cell = 16;
// Approximate bits of a difference without its lists: reference and two counts.
constexpr std::uint64_t delta_head_bits = 30;
constexpr std::uint64_t own_head_bits = 16;

// The differences between similar cells that save enough.
std::vector<saving_difference> saving_differences(std::span<const std::vector<run>> sets,
                                                  std::span<const std::uint32_t> first, const row_encoders& encoders,
                                                  std::uint32_t limit, const plan_settings& how) {
  const auto likely = likely_references(sets, first, limit, candidates_per_cell);
  std::vector<std::vector<saving_difference>> of_cell(sets.size());
  const auto compare = [&](std::size_t cell) {
    std::vector<run> removed;
    std::vector<run> added;
    const std::uint64_t own = own_head_bits + encoders.own.size(sets[cell]);
    const std::uint64_t most = how.least == least_saving::anything ? own : own - own / 8;
    for (const std::uint32_t other : likely[cell]) {
      make_rank_difference(sets[other], sets[cell], removed, added);
      const std::uint64_t delta = delta_head_bits + encoders.removed.size(removed) + encoders.added.size(added);
      if (delta < most) of_cell[cell].push_back({own - delta, static_cast<std::uint32_t>(cell), other});
    }
  };
  if (how.run_at_once) {
    how.run_at_once(sets.size(), compare);
  } else {
    for (std::size_t cell = 0; cell < sets.size(); ++cell) compare(cell);
  }
  std::vector<saving_difference> found;
  for (const std::vector<saving_difference>& one : of_cell) found.insert(found.end(), one.begin(), one.end());
  return found;
}

// A plan is kept for every chunk of a file, so it is small. no_cell becomes chunk_plan::alone.
std::vector<std::uint8_t> narrowed(std::span<const std::uint32_t> cells) {
  std::vector<std::uint8_t> narrow;
  for (const std::uint32_t cell : cells) narrow.push_back(static_cast<std::uint8_t>(cell));
  return narrow;
}
static_assert(static_cast<std::uint8_t>(no_cell) == chunk_plan::alone);

void put_count(std::size_t count, bit_sink& out) {
  const auto value = static_cast<std::uint32_t>(count);
  const auto bits = static_cast<unsigned>(std::bit_width(value));
  out.put(bits, 5);
  if (bits > 0) out.put(value, bits - 1);
}

}  // namespace

void row_counts::add(const row_counts& others) {
  own.add(others.own);
  removed.add(others.removed);
  added.add(others.added);
  list_runs = std::max(list_runs, others.list_runs);
}

chunk_plan plan_chunk(std::span<const std::vector<run>> sets, const row_encoders& encoders, std::uint32_t limit,
                      const plan_settings& how) {
  const std::vector<std::uint32_t> first = first_equal(sets);
  return {narrowed(first),
          narrowed(choose_references(sets.size(), saving_differences(sets, first, encoders, limit, how)))};
}

std::vector<std::uint64_t> row_bytes(std::span<const std::vector<run>> sets, const chunk_plan& plan,
                                     const row_encoders& encoders) {
  std::vector<std::uint64_t> bytes(sets.size());
  std::vector<run> removed;
  std::vector<run> added;
  for (std::size_t cell = 0; cell < sets.size(); ++cell) {
    if (plan.same[cell] != cell) continue;
    std::uint64_t bits = own_head_bits;
    if (plan.reference[cell] == chunk_plan::alone) {
      bits += encoders.own.size(sets[cell]);
    } else {
      make_rank_difference(sets[plan.reference[cell]], sets[cell], removed, added);
      bits = delta_head_bits + encoders.removed.size(removed) + encoders.added.size(added);
    }
    bytes[cell] = (bits + 7) / 8;
  }
  return bytes;
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
