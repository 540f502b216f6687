#pragma once
// Canonical prefix codes over the symbols of number_symbols.h (SPEC.md, "Code tables"). A code is given by its lengths:
// symbols of one length have consecutive codes in ascending order, shorter codes come first, and the first bit of a
// code is its highest one.
#include <array>
#include <cstdint>
#include <span>

#include "bit_reader.h"
#include "number_symbols.h"

namespace sightcell::format {

inline constexpr unsigned longest_code = 15;
// Bits of the code of each symbol, 0 for a symbol without a code.
using symbol_lengths = std::array<std::uint8_t, symbol_count>;

class prefix_code {
 public:
  static constexpr std::uint32_t no_symbol = 0xFFFFFFFFu;

  // A code without symbols: nothing can be decoded.
  prefix_code() noexcept = default;

  // lengths[s]: bits of symbol s, 0 where it has no code; up to symbol_count of them, each up to longest_code. True if
  // the codes are complete (every string of bits begins with one), if there is one symbol with one bit, or if there is
  // none. Else false, and a code without symbols.
  [[nodiscard]] bool assign(std::span<const std::uint8_t> lengths) noexcept;

  // The symbol whose code is at the begin of `bits` (lowest first), and its length; no_symbol if there is none.
  [[nodiscard]] std::uint32_t decode(std::uint64_t bits, unsigned& length) const noexcept {
    const entry e = table_[static_cast<std::size_t>(bits & (table_.size() - 1))];
    length = e.length;
    return e.length != 0 ? e.symbol : decode_long(bits, length);
  }

  // Calls emit(symbol, code, length) for each symbol that has a code, in the order of the codes. The bits of a code are
  // in the order of a file, lowest first.
  template <class Emit>
  void for_each(const Emit& emit) const {
    std::uint32_t code = 0;
    std::size_t at = 0;
    for (unsigned length = 1; length <= longest_code; ++length, code <<= 1) {
      for (std::uint32_t i = 0; i < count_[length]; ++i, ++code)
        emit(std::uint32_t{symbols_[at++]}, reversed(code, length), length);
    }
  }

 private:
  static std::uint32_t reversed(std::uint32_t code, unsigned length) noexcept {
    std::uint32_t out = 0;
    for (unsigned i = 0; i < length; ++i, code >>= 1) out = out << 1 | (code & 1u);
    return out;
  }

  [[nodiscard]] std::uint32_t decode_long(std::uint64_t bits, unsigned& length) const noexcept;

  static constexpr unsigned table_bits = 10;
  struct entry {
    std::uint8_t symbol = 0;
    std::uint8_t length = 0;  // 0: the code is longer than the table's index
  };
  std::array<entry, std::size_t{1} << table_bits> table_{};
  std::array<std::uint8_t, symbol_count> symbols_{};     // in the order of their codes
  std::array<std::uint16_t, longest_code + 1> count_{};  // codes of each length
  std::uint32_t used_ = 0;
};

}  // namespace sightcell::format
