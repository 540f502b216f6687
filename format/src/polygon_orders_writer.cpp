#include "polygon_orders_writer.h"

#include <array>

#include "bit_reader.h"
#include "bit_sink.h"
#include "byte_sink.h"
#include "code_lengths.h"
#include "code_table_writer.h"
#include "packed_columns_writer.h"
#include "prefix_code.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// Calls use(step, length - 1) for every run, as symbols. A run has one polygon, unless orders are in runs.
template <class Use>
void for_each_run(std::span<const std::uint32_t> source_of_stored, bool in_runs, const Use& use) {
  const std::size_t most = in_runs ? layout::max_order_run : 1;
  std::uint32_t expected = 0;  // the polygon after the one before
  for (std::size_t at = 0, end = 0; at < source_of_stored.size(); at = end) {
    for (end = at + 1; end < source_of_stored.size() && end - at < most; ++end) {
      if (source_of_stored[end] != source_of_stored[end - 1] + 1) break;
    }
    const std::uint32_t step = source_of_stored[at] - expected;
    use(symbol_of(step << 1 ^ (0 - (step >> 31))), symbol_of(static_cast<std::uint32_t>(end - at - 1)));
    expected = source_of_stored[end - 1] + 1;
  }
}

// The code that is best for some symbols.
struct best_code {
  symbol_lengths lengths{};
  std::array<std::uint32_t, symbol_count> codes{};

  explicit best_code(const symbol_counts& counts) : lengths(best_lengths(counts)) {
    prefix_code code;
    if (code.assign(lengths)) {
      code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned) { codes[symbol] = bits; });
    }
  }
  void put(const number_symbol& n, bit_sink& bits) const {
    bits.put(codes[n.symbol], lengths[n.symbol]);
    bits.put(n.raw, n.raw_bits);
  }
};

}  // namespace

void put_orders(std::span<const std::vector<std::uint32_t>> orders, std::vector<std::byte>& out, bool in_runs) {
  symbol_counts step_counts{};
  symbol_counts length_counts{};
  for (const auto& order : orders) {
    for_each_run(order, in_runs, [&](const number_symbol& step, const number_symbol& more) {
      ++step_counts[step.symbol];
      ++length_counts[more.symbol];
    });
  }
  const best_code steps(step_counts);
  const best_code lengths(length_counts);

  std::vector<std::vector<std::uint32_t>> columns(2, std::vector<std::uint32_t>{0});
  std::vector<std::byte> permutations;
  for (const auto& order : orders) {
    bit_sink bits(permutations);
    for_each_run(order, in_runs, [&](const number_symbol& step, const number_symbol& more) {
      steps.put(step, bits);
      if (in_runs) lengths.put(more, bits);
    });
    bits.align();
    columns[0].push_back(columns[0].back() + static_cast<std::uint32_t>(order.size()));
    columns[1].push_back(static_cast<std::uint32_t>(permutations.size()));
  }

  byte_sink bytes(out);
  bytes.put_u32(static_cast<std::uint32_t>(orders.size()));
  put_columns(columns, out);
  put_code_lengths(steps.lengths, out);
  if (in_runs) put_code_lengths(lengths.lengths, out);
  bytes.put_bytes(permutations);
  out.insert(out.end(), bit_reader::padding, std::byte{0});
}

}  // namespace sightcell::format
