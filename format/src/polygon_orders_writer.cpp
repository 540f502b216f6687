#include "polygon_orders_writer.h"

#include <algorithm>

#include "bit_reader.h"
#include "bit_sink.h"
#include "byte_sink.h"
#include "code_lengths.h"
#include "code_table_writer.h"
#include "packed_columns_writer.h"
#include "prefix_code.h"

namespace sightcell::format {
namespace {

// Calls use(begins an atom, symbol) for every polygon.
template <class Use>
void for_each_symbol(const polygon_order& order, const Use& use) {
  std::uint32_t expected = 0;  // the polygon behind the one before
  for (std::size_t i = 0; i < order.source_of_stored.size(); ++i) {
    const std::uint32_t step = order.source_of_stored[i] - expected;
    const bool back = (step >> 31) != 0;
    use(order.begins_atom[i], symbol_of(order.begins_atom[i] ? step << 1 ^ (back ? 0xFFFFFFFFu : 0u) : step));
    expected = order.source_of_stored[i] + 1;
  }
}

// What a symbol's code is, for both kinds.
struct permutation_code {
  explicit permutation_code(const symbol_counts& counts) : lengths(best_lengths(counts)) {
    prefix_code code;
    if (!code.assign(lengths)) return;
    code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned) { codes[symbol] = bits; });
  }
  symbol_lengths lengths;
  std::array<std::uint32_t, symbol_count> codes{};
};

}  // namespace

void put_orders(std::span<const polygon_order> orders, std::vector<std::byte>& out) {
  symbol_counts begin_counts{};
  symbol_counts follow_counts{};
  for (const polygon_order& order : orders) {
    for_each_symbol(order,
                    [&](bool begins, const number_symbol& n) { ++(begins ? begin_counts : follow_counts)[n.symbol]; });
  }
  const permutation_code begins_code(begin_counts);
  const permutation_code follows_code(follow_counts);

  std::vector<std::vector<std::uint32_t>> columns(3, std::vector<std::uint32_t>{0});
  std::vector<std::byte> atoms, permutations;
  bit_sink atom_bits(atoms);
  for (const polygon_order& order : orders) {
    for (const bool begins : order.begins_atom) atom_bits.put(begins ? 1 : 0, 1);
    bit_sink bits(permutations);
    for_each_symbol(order, [&](bool begins, const number_symbol& n) {
      const permutation_code& code = begins ? begins_code : follows_code;
      bits.put(code.codes[n.symbol], code.lengths[n.symbol]);
      bits.put(n.raw, n.raw_bits);
    });
    bits.align();
    const auto atom_count = std::count(order.begins_atom.begin(), order.begins_atom.end(), true);
    columns[0].push_back(columns[0].back() + static_cast<std::uint32_t>(order.source_of_stored.size()));
    columns[1].push_back(columns[1].back() + static_cast<std::uint32_t>(atom_count));
    columns[2].push_back(static_cast<std::uint32_t>(permutations.size()));
  }
  atom_bits.align();

  byte_sink bytes(out);
  bytes.put_u32(static_cast<std::uint32_t>(orders.size()));
  put_columns(columns, out);
  bytes.put_bytes(atoms);
  put_code_lengths(begins_code.lengths, out);
  put_code_lengths(follows_code.lengths, out);
  bytes.put_bytes(permutations);
  out.insert(out.end(), bit_reader::padding, std::byte{0});
}

void sort_atoms(polygon_order& order) {
  auto begin = order.source_of_stored.begin();
  for (std::size_t i = 1; i <= order.source_of_stored.size(); ++i) {
    if (i < order.source_of_stored.size() && !order.begins_atom[i]) continue;
    const auto end = order.source_of_stored.begin() + static_cast<std::ptrdiff_t>(i);
    std::sort(begin, end);
    begin = end;
  }
}

}  // namespace sightcell::format
