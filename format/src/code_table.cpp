#include "code_table.h"

#include "checked_reader.h"

namespace sightcell::format {

bool read_code_lengths(std::span<const std::byte>& bytes, symbol_lengths& lengths) noexcept {
  const checked_reader in(bytes);
  std::uint8_t count = 0;
  if (!in.read_u8(0, count) || count > symbol_count) return false;
  const std::size_t size = 1 + (std::size_t{count} + 1) / 2;
  if (size > bytes.size()) return false;
  lengths = symbol_lengths{};
  for (std::uint32_t symbol = 0; symbol < count; ++symbol) {
    std::uint8_t both = 0;
    if (!in.read_u8(1 + symbol / 2, both)) return false;
    lengths[symbol] = symbol % 2 == 0 ? both & 0xFu : both >> 4;
  }
  bytes = bytes.subspan(size);
  return true;
}

bool read_code(std::span<const std::byte>& bytes, prefix_code& code) noexcept {
  symbol_lengths lengths{};
  return read_code_lengths(bytes, lengths) && code.assign(lengths);
}

}  // namespace sightcell::format
