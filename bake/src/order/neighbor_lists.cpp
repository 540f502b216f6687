#include "order/neighbor_lists.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>
#include <tuple>
#include <utility>

#include "sightcell/base/in_blocks.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {
namespace {

constexpr std::uint32_t places_ahead = 3;  // rows of a sort that are proposed to each other
constexpr std::uint32_t few_rows = 64;     // up to here comparing all pairs costs less than sorts
// First set bits by which rows are sorted; with 8, paths of thousands of rows break.
constexpr std::uint32_t bits_of_key = 16;
constexpr std::uint32_t last_rank = 65535;  // of a column: ranks take 16 bits of a key

struct permutation {
  std::vector<std::uint16_t> rank_of;    // of a column
  std::vector<std::uint16_t> column_at;  // a rank
};

permutation permuted_columns(std::uint32_t columns, std::uint64_t seed) {
  permutation made;
  made.rank_of.resize(columns);
  for (std::uint32_t i = 0; i < columns; ++i) made.rank_of[i] = static_cast<std::uint16_t>(i);
  std::uint64_t state = seed;
  for (std::uint32_t i = columns; i > 1; --i)
    std::swap(made.rank_of[i - 1], made.rank_of[mix_bits(state += 0x9E3779B97F4A7C15ull) % i]);
  made.column_at.resize(columns);
  for (std::uint32_t i = 0; i < columns; ++i) made.column_at[made.rank_of[i]] = static_cast<std::uint16_t>(i);
  return made;
}

using sort_key = std::array<std::uint64_t, bits_of_key / 4>;
using first_ranks = std::array<std::uint32_t, bits_of_key + 1>;  // ascending; the last is scratch

// Both return how many of the row's lowest ranks they found: bits_of_key, or all.
std::uint32_t ranks_by_bits(std::span<const std::uint64_t> row, const permutation& columns, first_ranks& first) {
  std::uint32_t found = 0;
  for (std::size_t word = 0; word < row.size(); ++word)
    for (std::uint64_t bits = row[word]; bits != 0; bits &= bits - 1) {
      const std::uint32_t rank = columns.rank_of[word * 64 + static_cast<std::uint32_t>(std::countr_zero(bits))];
      if (found == bits_of_key && rank > first[found - 1]) continue;
      std::uint32_t at = found;
      for (; at > 0 && first[at - 1] > rank; --at) first[at] = first[at - 1];
      first[at] = rank;
      found = std::min(found + 1, bits_of_key);
    }
  return found;
}

std::uint32_t ranks_in_order(std::span<const std::uint64_t> row, const permutation& columns, first_ranks& first) {
  std::uint32_t found = 0;
  for (std::uint32_t rank = 0; rank < columns.column_at.size() && found < bits_of_key; ++rank) {
    const std::uint32_t column = columns.column_at[rank];
    first[found] = rank;
    found += static_cast<std::uint32_t>(row[column / 64] >> (column % 64) & 1);
  }
  return found;
}

// Returns the ranks of the first set bits, every second one in descending order. As in a Gray code, rows that are
// adjacent where one bit changes are then near in the bits that follow.
sort_key key_of(std::span<const std::uint64_t> row, const permutation& columns) {
  std::uint64_t set_bits = 0;
  for (const std::uint64_t word : row) set_bits += static_cast<std::uint64_t>(std::popcount(word));
  first_ranks first{};
  // In the order of ranks it takes about bits_of_key * columns / set_bits steps to find as many.
  const bool dense = set_bits * set_bits > bits_of_key * columns.rank_of.size();
  const std::uint32_t found = dense ? ranks_in_order(row, columns, first) : ranks_by_bits(row, columns, first);
  sort_key key{};
  for (std::uint32_t i = 0; i < found; ++i)
    key[i / 4] |= std::uint64_t{i % 2 == 1 ? first[i] : last_rank - first[i]} << (48 - 16 * (i % 4));
  return key;
}

}  // namespace

void neighbor_lists::add(std::uint32_t row, std::uint32_t other, std::int32_t distance) {
  const std::span<near_row> list = std::span(near_).subspan(std::size_t{row} * kept_, kept_);
  if (distance >= list.back().distance) return;
  for (const near_row& known : list) {
    if (known.row == other) return;
    if (known.row == no_row) break;
  }
  std::size_t at = list.size() - 1;
  for (; at > 0 && list[at - 1].distance > distance; --at) list[at] = list[at - 1];
  list[at] = {.row = other, .distance = distance};
}

void neighbor_lists::add_in_order(const bit_matrix& matrix, std::span<const std::uint32_t> order, std::uint32_t ahead) {
  const std::size_t count = order.size();
  std::vector<std::int32_t> distances(count * ahead);  // [i * ahead + k - 1]: from position i to i + k
  in_blocks(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 1; k <= ahead && i + k < count; ++k)
        distances[i * ahead + k - 1] = matrix.distance(order[i], order[i + k]);
  });
  in_blocks(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 1; k <= ahead; ++k) {
        if (i >= k) add(order[i], order[i - k], distances[(i - k) * ahead + k - 1]);
        if (i + k < count) add(order[i], order[i + k], distances[i * ahead + k - 1]);
      }
  });
}

std::vector<std::uint32_t> sorted_by_permuted_bits(const bit_matrix& matrix, std::span<const std::uint32_t> rows,
                                                   std::uint64_t seed) {
  struct item {
    sort_key key;
    std::uint32_t place;
  };
  const permutation columns = permuted_columns(matrix.columns(), seed);
  std::vector<item> items(rows.size());
  in_blocks(rows.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      items[i] = {key_of(matrix.row(rows[i]), columns), static_cast<std::uint32_t>(i)};
  });
  sort_without_ties(items,
                    [](const item& a, const item& b) { return std::tie(a.key, a.place) < std::tie(b.key, b.place); });
  std::vector<std::uint32_t> sorted(rows.size());
  for (std::size_t i = 0; i < items.size(); ++i) sorted[i] = rows[items[i].place];
  return sorted;
}

neighbor_lists neighbors_by_sorts(const bit_matrix& matrix, std::span<const std::uint32_t> rows, std::uint32_t kept,
                                  std::uint32_t sorts, std::uint64_t first_seed) {
  neighbor_lists found(matrix.rows(), kept);
  if (rows.size() <= few_rows) {
    found.add_in_order(matrix, rows, few_rows);
    return found;
  }
  found.add_in_order(matrix, rows, places_ahead);
  for (std::uint64_t seed = first_seed; seed < first_seed + sorts; ++seed)
    found.add_in_order(matrix, sorted_by_permuted_bits(matrix, rows, seed), places_ahead);
  return found;
}

}  // namespace sightcell::bake
