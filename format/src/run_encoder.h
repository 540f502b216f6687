#pragma once
// Writes lists of runs (SPEC.md, "Rows"), which are ascending, disjoint and do not touch. The counterpart for reading
// is run_code.h.
#include <array>
#include <cstdint>
#include <span>

#include "bit_sink.h"
#include "code_lengths.h"
#include "prefix_code.h"
#include "sightcell/format/records.h"

namespace sightcell::format {

// Counts of each symbol in lists of runs.
struct run_counts {
  symbol_counts gap{};
  symbol_counts more{};

  void add(std::span<const run> runs);
  void add(const run_counts& others);
};

class run_encoder {
 public:
  // The best codes for lists of runs with these counts.
  explicit run_encoder(const run_counts& counts);

  [[nodiscard]] const symbol_lengths& gap_lengths() const { return gap_lengths_; }
  [[nodiscard]] const symbol_lengths& more_lengths() const { return more_lengths_; }

  // Bits that encode() appends. Symbols without a code count as longest_code bits, so that lists can be compared before
  // the final codes are known.
  [[nodiscard]] std::uint64_t size(std::span<const run> runs) const;
  // All symbols must have been counted.
  void encode(std::span<const run> runs, bit_sink& out) const;

 private:
  using symbol_codes = std::array<std::uint32_t, symbol_count>;
  static symbol_codes codes_of(const symbol_lengths& lengths);

  symbol_lengths gap_lengths_, more_lengths_;
  symbol_codes gap_codes_, more_codes_;
};

}  // namespace sightcell::format
