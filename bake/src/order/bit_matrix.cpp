#include "order/bit_matrix.h"

#include <algorithm>
#include <bit>

#include "sightcell/base/random.h"

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define SIGHTCELL_HAS_POPCNT_CHOICE
#endif

namespace sightcell::bake {
namespace {

// Without the popcnt instruction, popcount is a call that uses a table.
std::int32_t count_portably(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) {
  std::int32_t count = 0;
  for (std::size_t i = 0; i < words; ++i) count += std::popcount(a[i] ^ b[i]);
  return count;
}

#ifdef SIGHTCELL_HAS_POPCNT_CHOICE
__attribute__((target("popcnt"))) std::int32_t count_natively(const std::uint64_t* a, const std::uint64_t* b,
                                                              std::size_t words) {
  std::int32_t count = 0;
  for (std::size_t i = 0; i < words; ++i) count += __builtin_popcountll(a[i] ^ b[i]);
  return count;
}
#endif

}  // namespace

bit_matrix::counter bit_matrix::best_counter() {
#ifdef SIGHTCELL_HAS_POPCNT_CHOICE
  if (__builtin_cpu_supports("popcnt")) return count_natively;
#endif
  return count_portably;
}

bit_matrix::bit_matrix(std::uint32_t rows, std::uint32_t columns)
    : rows_(rows),
      words_(std::max(1u, columns / 64 + (columns % 64 != 0 ? 1 : 0))),
      bits_(std::size_t{rows_} * words_),
      count_differences_(best_counter()) {}

void bit_matrix::clear(std::uint32_t r) {
  std::ranges::fill(row(r), 0);
}

std::uint32_t folded_column(std::uint64_t column, std::uint64_t columns, const bit_matrix& matrix) {
  if (columns <= matrix.columns()) return static_cast<std::uint32_t>(column);
  return static_cast<std::uint32_t>(mix_bits(column + 0x9E3779B97F4A7C15ull) % matrix.columns());
}

}  // namespace sightcell::bake
