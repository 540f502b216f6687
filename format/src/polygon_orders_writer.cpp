#include "polygon_orders_writer.h"

#include <array>

#include "bit_reader.h"
#include "bit_sink.h"
#include "byte_sink.h"
#include "code_lengths.h"
#include "code_table_writer.h"
#include "packed_columns_writer.h"
#include "prefix_code.h"

namespace sightcell::format {
namespace {

// Calls use(symbol) for every polygon.
template <class Use>
void for_each_symbol(std::span<const std::uint32_t> source_of_stored, const Use& use) {
  std::uint32_t expected = 0;  // the polygon after the one before
  for (const std::uint32_t polygon : source_of_stored) {
    const std::uint32_t step = polygon - expected;
    use(symbol_of(step << 1 ^ (0 - (step >> 31))));
    expected = polygon + 1;
  }
}

}  // namespace

void put_orders(std::span<const std::vector<std::uint32_t>> orders, std::vector<std::byte>& out) {
  symbol_counts counts{};
  for (const auto& order : orders) for_each_symbol(order, [&](const number_symbol& n) { ++counts[n.symbol]; });
  const symbol_lengths lengths = best_lengths(counts);
  std::array<std::uint32_t, symbol_count> codes{};
  prefix_code code;
  if (code.assign(lengths)) {
    code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned) { codes[symbol] = bits; });
  }

  std::vector<std::vector<std::uint32_t>> columns(2, std::vector<std::uint32_t>{0});
  std::vector<std::byte> permutations;
  for (const auto& order : orders) {
    bit_sink bits(permutations);
    for_each_symbol(order, [&](const number_symbol& n) {
      bits.put(codes[n.symbol], lengths[n.symbol]);
      bits.put(n.raw, n.raw_bits);
    });
    bits.align();
    columns[0].push_back(columns[0].back() + static_cast<std::uint32_t>(order.size()));
    columns[1].push_back(static_cast<std::uint32_t>(permutations.size()));
  }

  byte_sink bytes(out);
  bytes.put_u32(static_cast<std::uint32_t>(orders.size()));
  put_columns(columns, out);
  put_code_lengths(lengths, out);
  bytes.put_bytes(permutations);
  out.insert(out.end(), bit_reader::padding, std::byte{0});
}

}  // namespace sightcell::format
