#include "run_encoder.h"

namespace sightcell::format {
namespace {

// Calls use(gap, length - 1) for every run.
template <class Use>
void for_each_pair(std::span<const run> runs, const Use& use) {
  std::uint32_t next = 0;  // the lowest number with which the run may begin
  for (const run& r : runs) {
    use(symbol_of(r.first - next), symbol_of(r.count - 1));
    next = r.first + r.count + 1;
  }
}

unsigned size_of(const symbol_lengths& lengths, const number_symbol& n) {
  const unsigned length = lengths[n.symbol];
  return (length == 0 ? longest_code : length) + n.raw_bits;
}

}  // namespace

void run_counts::add(std::span<const run> runs) {
  for_each_pair(runs, [&](const number_symbol& g, const number_symbol& m) {
    ++gap[g.symbol];
    ++more[m.symbol];
  });
}

void run_counts::add(const run_counts& others) {
  for (std::size_t symbol = 0; symbol < gap.size(); ++symbol) {
    gap[symbol] += others.gap[symbol];
    more[symbol] += others.more[symbol];
  }
}

run_encoder::run_encoder(const run_counts& counts)
    : gap_lengths_(best_lengths(counts.gap)),
      more_lengths_(best_lengths(counts.more)),
      gap_codes_(codes_of(gap_lengths_)),
      more_codes_(codes_of(more_lengths_)) {}

run_encoder::symbol_codes run_encoder::codes_of(const symbol_lengths& lengths) {
  symbol_codes codes{};
  prefix_code code;
  if (code.assign(lengths)) {
    code.for_each([&](std::uint32_t symbol, std::uint32_t bits, unsigned) { codes[symbol] = bits; });
  }
  return codes;
}

std::uint64_t run_encoder::size(std::span<const run> runs) const {
  std::uint64_t bits = 0;
  for_each_pair(runs, [&](const number_symbol& g, const number_symbol& m) {
    bits += size_of(gap_lengths_, g) + size_of(more_lengths_, m);
  });
  return bits;
}

void run_encoder::encode(std::span<const run> runs, bit_sink& out) const {
  for_each_pair(runs, [&](const number_symbol& g, const number_symbol& m) {
    out.put(gap_codes_[g.symbol], gap_lengths_[g.symbol]);
    out.put(more_codes_[m.symbol], more_lengths_[m.symbol]);
    out.put(g.raw, g.raw_bits);
    out.put(m.raw, m.raw_bits);
  });
}

}  // namespace sightcell::format
