#include "polygon_orders.h"

#include "bit_reader.h"
#include "checked_reader.h"
#include "code_table.h"

namespace sightcell::format {

bool polygon_orders::open(std::span<const std::byte> bytes) noexcept {
  *this = polygon_orders{};
  polygon_orders made;
  std::uint64_t size = 0;
  packed_columns columns;
  const checked_reader in(bytes);
  if (!in.read_u32(0, made.count_) || made.count_ == 0xFFFFFFFFu) return false;
  bytes = bytes.subspan(4);
  if (!packed_columns::size_of(bytes, 2, made.count_ + 1, size)) return false;
  if (!columns.open(bytes.first(static_cast<std::size_t>(size)), 2, made.count_ + 1)) return false;
  made.first_polygon_ = packed_column(columns, 0);
  made.first_byte_ = packed_column(columns, 1);
  bytes = bytes.subspan(static_cast<std::size_t>(size));
  if (!read_code(bytes, made.steps_)) return false;
  if (bytes.size() != std::uint64_t{made.first_byte_[made.count_]} + bit_reader::padding) return false;
  made.permutations_ = bytes;
  if (made.first_polygon_[0] != 0) return false;
  for (std::uint32_t number = 0; number < made.count_; ++number) {
    if (made.first_polygon_[number + 1] < made.first_polygon_[number]) return false;
  }
  *this = made;
  return true;
}

bool polygon_orders::source_of_stored(std::uint32_t number, std::span<std::uint32_t> out) const noexcept {
  if (number >= count_ || out.size() != polygon_count(number)) return false;
  bit_reader in(permutations_);
  in.seek(8 * std::uint64_t{first_byte_[number]});
  std::uint32_t expected = 0;  // the polygon behind the one before
  for (std::uint32_t& polygon : out) {
    unsigned length = 0;
    const std::uint32_t symbol = steps_.decode(in.peek(), length);
    if (symbol == prefix_code::no_symbol) return false;
    in.skip(length);
    const std::uint32_t value = base_of(symbol) + in.take(raw_bits_of(symbol));
    polygon = expected + (value >> 1 ^ (0 - (value & 1u)));  // odd values are steps back
    if (polygon >= out.size() || in.beyond_end()) return false;
    expected = polygon + 1;
  }
  return true;
}

}  // namespace sightcell::format
