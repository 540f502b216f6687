#include "prefix_code.h"

namespace sightcell::format {

bool prefix_code::assign(std::span<const std::uint8_t> lengths) noexcept {
  *this = prefix_code{};
  if (lengths.size() > symbol_count) return false;
  prefix_code made;
  for (const std::uint8_t length : lengths) {
    if (length > longest_code) return false;
    if (length > 0) ++made.count_[length];
  }
  std::uint32_t taken = 0;  // of all strings of longest_code bits, how many begin with a code
  std::array<std::uint32_t, longest_code + 2> begin{};
  for (unsigned length = 1; length <= longest_code; ++length) {
    taken += std::uint32_t{made.count_[length]} << (longest_code - length);
    begin[length + 1] = begin[length] + made.count_[length];
    made.used_ += made.count_[length];
  }
  constexpr std::uint32_t all = std::uint32_t{1} << longest_code;
  const bool alone = made.used_ == 1 && made.count_[1] == 1;
  if (taken != all && !alone && made.used_ != 0) return false;
  for (std::uint32_t symbol = 0; symbol < lengths.size(); ++symbol) {
    if (lengths[symbol] > 0) made.symbols_[begin[lengths[symbol]]++] = static_cast<std::uint8_t>(symbol);
  }
  made.for_each([&](std::uint32_t symbol, std::uint32_t code, unsigned length) {
    for (std::size_t at = code; length <= table_bits && at < made.table_.size(); at += std::size_t{1} << length) {
      made.table_[at] = {static_cast<std::uint8_t>(symbol), static_cast<std::uint8_t>(length)};
    }
  });
  *this = made;
  return true;
}

// Bit by bit: compares the code with the range of codes of each length.
std::uint32_t prefix_code::decode_long(std::uint64_t bits, unsigned& length) const noexcept {
  std::uint32_t code = 0;
  std::uint32_t first = 0;  // code of the first symbol of this length
  std::uint32_t at = 0;     // its index in symbols_
  for (length = 1; length <= longest_code; ++length, bits >>= 1) {
    code |= static_cast<std::uint32_t>(bits & 1u);
    const std::uint32_t count = count_[length];
    if (code - first < count) return symbols_[at + code - first];
    at += count;
    first = (first + count) << 1;
    code <<= 1;
  }
  return no_symbol;
}

}  // namespace sightcell::format
