#pragma once
// Reads lists of runs (SPEC.md, "Rows"): for each run the code of its gap, the code of its length - 1, then the raw
// bits of both. One table lookup returns both symbols of almost every run. The counterpart for writing is
// run_encoder.h.
#include <array>
#include <cstdint>
#include <span>

#include "bit_reader.h"
#include "prefix_code.h"

namespace sightcell::format {

class run_code {
 public:
  // Sets both codes; false if one of them is invalid (prefix_code::assign). About 21 KiB, all inside the object.
  [[nodiscard]] bool assign(std::span<const std::uint8_t> gap_lengths,
                            std::span<const std::uint8_t> more_lengths) noexcept;

  // Reads the next `count` runs of `in`, ascending, disjoint and not touching, all below limit, as their borders: out[2
  // i] is the first number of run i, out[2 i + 1] the one after its last. False if the bits are invalid, exceed limit
  // or the end of in, or out is too small; out is undefined then.
  [[nodiscard]] bool decode(bit_reader& in, std::uint32_t count, std::uint32_t limit,
                            std::span<std::uint32_t> out) const noexcept;

 private:
  static constexpr unsigned table_bits = 12;
  // The meaning of the lowest bits of a list, in a word: tables of 16 KiB for each kind of list stay in the processor's
  // cache where tables of twice the size would not. A number is head << raw bits, plus the raw bits. bits() is 0 if the
  // codes are longer than the table's index, or there are more raw bits than one peek returns.
  class entry {
   public:
    entry() noexcept = default;
    entry(unsigned bits, unsigned code_bits, std::uint32_t gap_symbol, std::uint32_t more_symbol) noexcept
        : word_(bits | code_bits << 8 | raw_bits_of(gap_symbol) << 12 | raw_bits_of(more_symbol) << 17 |
                head_of(gap_symbol) << 22 | head_of(more_symbol) << 24) {}

    [[nodiscard]] unsigned bits() const noexcept { return word_ & 0xFFu; }             // all of them
    [[nodiscard]] unsigned code_bits() const noexcept { return word_ >> 8 & 0xFu; }    // of both codes
    [[nodiscard]] unsigned gap_bits() const noexcept { return word_ >> 12 & 0x1Fu; }   // raw
    [[nodiscard]] unsigned more_bits() const noexcept { return word_ >> 17 & 0x1Fu; }  // raw
    [[nodiscard]] std::uint32_t gap_head() const noexcept { return word_ >> 22 & 3u; }
    [[nodiscard]] std::uint32_t more_head() const noexcept { return word_ >> 24 & 3u; }

   private:
    std::uint32_t word_ = 0;
  };

  void fill_table() noexcept;
  [[nodiscard]] bool decode_long(bit_buffer& held, std::uint32_t& gap, std::uint32_t& more) const noexcept;

  prefix_code gap_, more_;
  std::array<entry, std::size_t{1} << table_bits> table_{};
};

}  // namespace sightcell::format
