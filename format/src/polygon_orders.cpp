#include "polygon_orders.h"

#include "bit_reader.h"
#include "checked_reader.h"
#include "code_table.h"
#include "sightcell/format/layout.h"

namespace sightcell::format {
namespace {

// False if the bits are no code.
bool take_number(bit_reader& in, const prefix_code& code, std::uint32_t& out) noexcept {
  unsigned length = 0;
  const std::uint32_t symbol = code.decode(in.peek(), length);
  if (symbol == prefix_code::no_symbol) return false;
  in.skip(length);
  out = base_of(symbol) + in.take(raw_bits_of(symbol));
  return true;
}

}  // namespace

bool polygon_orders::open(std::span<const std::byte> bytes, std::uint32_t most, bool in_runs) noexcept {
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
  if (!read_code(bytes, steps_) || (in_runs && !read_code(bytes, lengths_))) return false;
  if (bytes.size() != std::uint64_t{first_byte[count]} + bit_reader::padding || first_polygon[0] != 0 ||
      first_byte[0] != 0) {
    return false;
  }
  // Orders follow each other, and a polygon takes a bit or more, or a run two bits: a small file cannot make a host
  // allocate much.
  const std::uint64_t most_per_bit = in_runs ? layout::max_order_run / 2 : 1;
  for (std::uint32_t number = 0; number < count; ++number) {
    if (first_polygon[number + 1] < first_polygon[number] || first_byte[number + 1] < first_byte[number]) return false;
    const std::uint64_t bits = 8 * (std::uint64_t{first_byte[number + 1]} - first_byte[number]);
    if (first_polygon[number + 1] - first_polygon[number] > most_per_bit * bits) return false;
  }
  permutations_ = bytes;
  first_polygon_ = first_polygon;
  first_byte_ = first_byte;
  count_ = count;
  in_runs_ = in_runs;
  return true;
}

bool polygon_orders::source_of_stored(std::uint32_t number, std::span<std::uint32_t> out) const noexcept {
  if (number >= count_ || out.size() != polygon_count(number)) return false;
  bit_reader in(permutations_);
  in.seek(8 * std::uint64_t{first_byte_[number]});
  std::uint32_t expected = 0;  // the polygon after the one before
  for (std::size_t at = 0; at < out.size();) {
    std::uint32_t value = 0;
    std::uint32_t more = 0;
    if (!take_number(in, steps_, value) || (in_runs_ && !take_number(in, lengths_, more))) return false;
    const std::uint32_t polygon = expected + (value >> 1 ^ (0 - (value & 1u)));  // odd values are steps back
    if (polygon >= out.size() || in.beyond_end()) return false;
    if (more >= layout::max_order_run || more >= out.size() - at || more >= out.size() - polygon) return false;
    for (std::uint32_t i = 0; i <= more; ++i) out[at++] = polygon + i;
    expected = polygon + more + 1;
  }
  return (in.place() + 7) / 8 == first_byte_[number + 1];
}

}  // namespace sightcell::format
