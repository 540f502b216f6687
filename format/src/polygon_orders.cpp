#include "polygon_orders.h"

#include "bit_reader.h"
#include "checked_reader.h"
#include "code_table.h"

namespace sightcell::format {

bool polygon_orders::open(std::span<const std::byte> bytes, std::uint32_t most) noexcept {
  std::uint32_t count = 0;
  std::uint64_t size = 0;
  packed_columns columns;
  if (!checked_reader(bytes).read_u32(0, count) || count > most) return false;
  bytes = bytes.subspan(4);
  if (!packed_columns::size_of(bytes, 2, count + 1, size)) return false;
  if (!columns.open(bytes.first(static_cast<std::size_t>(size)), 2, count + 1)) return false;
  const packed_column first_polygon(columns, 0);
  const packed_column first_byte(columns, 1);
  bytes = bytes.subspan(static_cast<std::size_t>(size));
  if (!read_code(bytes, steps_)) return false;
  if (bytes.size() != std::uint64_t{first_byte[count]} + bit_reader::padding || first_polygon[0] != 0 ||
      first_byte[0] != 0) {
    return false;
  }
  // Orders follow each other, and a polygon takes a bit or more: a small file cannot make a host allocate much.
  for (std::uint32_t number = 0; number < count; ++number) {
    if (first_polygon[number + 1] < first_polygon[number] || first_byte[number + 1] < first_byte[number]) return false;
    const std::uint64_t bits = 8 * (std::uint64_t{first_byte[number + 1]} - first_byte[number]);
    if (first_polygon[number + 1] - first_polygon[number] > bits) return false;
  }
  permutations_ = bytes;
  first_polygon_ = first_polygon;
  first_byte_ = first_byte;
  count_ = count;
  return true;
}

bool polygon_orders::source_of_stored(std::uint32_t number, std::span<std::uint32_t> out) const noexcept {
  if (number >= count_ || out.size() != polygon_count(number)) return false;
  bit_reader in(permutations_);
  in.seek(8 * std::uint64_t{first_byte_[number]});
  std::uint32_t expected = 0;  // the polygon after the one before
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
  return (in.place() + 7) / 8 == first_byte_[number + 1];
}

}  // namespace sightcell::format
