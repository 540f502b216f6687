#pragma once
// Numbers as a symbol, which gets a prefix code, followed by raw bits (SPEC.md, "Numbers"). 0 .. 3 have their own
// symbols; above that each power of two has two symbols. Most numbers in a file are small, and within half a power of
// two all are about equally likely.
#include <bit>
#include <cstdint>

namespace sightcell::format {

inline constexpr std::uint32_t direct_symbols = 4;
// Symbols 0 .. 63: enough for every u32.
inline constexpr std::uint32_t symbol_count = direct_symbols + 2 * 30;

struct number_symbol {
  std::uint32_t symbol = 0;
  std::uint32_t raw = 0;
  unsigned raw_bits = 0;  // 0 .. 30
};

[[nodiscard]] constexpr number_symbol symbol_of(std::uint32_t value) noexcept {
  if (value < direct_symbols) return {value, 0, 0};
  const auto power = static_cast<unsigned>(31 - std::countl_zero(value));  // 2 .. 31
  const unsigned raw_bits = power - 1;
  return {direct_symbols + 2 * (power - 2) + ((value >> raw_bits) & 1u), value & ((std::uint32_t{1} << raw_bits) - 1),
          raw_bits};
}

// The number of raw bits after a symbol. symbol: below symbol_count.
[[nodiscard]] constexpr unsigned raw_bits_of(std::uint32_t symbol) noexcept {
  return symbol < direct_symbols ? 0 : (symbol - direct_symbols) / 2 + 1;
}
// The bits before the raw ones: a number is head << raw bits, plus the raw bits.
[[nodiscard]] constexpr std::uint32_t head_of(std::uint32_t symbol) noexcept {
  return symbol < direct_symbols ? symbol : 2 + (symbol - direct_symbols) % 2;
}
// The number if all raw bits are zero.
[[nodiscard]] constexpr std::uint32_t base_of(std::uint32_t symbol) noexcept {
  return head_of(symbol) << raw_bits_of(symbol);
}

static_assert(symbol_of(3).symbol == 3 && symbol_of(4).symbol == 4 && symbol_of(5).raw == 1);
static_assert(base_of(4) == 4 && base_of(5) == 6 && base_of(6) == 8 && raw_bits_of(symbol_count - 1) == 30);
static_assert(symbol_of(0xFFFFFFFFu).symbol == symbol_count - 1);

}  // namespace sightcell::format
