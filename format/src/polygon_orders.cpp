#include "polygon_orders.h"

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
  if (!packed_columns::size_of(bytes, 3, made.count_ + 1, size)) return false;
  if (!columns.open(bytes.first(static_cast<std::size_t>(size)), 3, made.count_ + 1)) return false;
  made.first_polygon_ = packed_column(columns, 0);
  made.first_atom_ = packed_column(columns, 1);
  made.first_byte_ = packed_column(columns, 2);
  bytes = bytes.subspan(static_cast<std::size_t>(size));

  const std::uint64_t atom_bytes = (std::uint64_t{made.polygons()} + 7) / 8;
  if (atom_bytes > bytes.size()) return false;
  made.atom_bits_ = bytes.first(static_cast<std::size_t>(atom_bytes));
  bytes = bytes.subspan(static_cast<std::size_t>(atom_bytes));
  if (!read_code(bytes, made.begins_) || !read_code(bytes, made.follows_)) return false;
  if (bytes.size() != std::uint64_t{made.first_byte_[made.count_]} + bit_reader::padding) return false;
  made.permutations_ = bytes;
  if (!made.check_shape()) return false;
  *this = made;
  return true;
}

bool polygon_orders::begins_atom(std::uint64_t polygon) const noexcept {
  std::uint8_t byte = 0;
  return checked_reader(atom_bits_).read_u8(polygon / 8, byte) && (byte >> (polygon % 8) & 1) != 0;
}

// Orders follow each other, and each has as many atoms as begin in it.
bool polygon_orders::check_shape() const noexcept {
  if (first_polygon_[0] != 0 || first_atom_[0] != 0 || first_byte_[0] != 0) return false;
  for (std::uint32_t number = 0; number < count_; ++number) {
    const std::uint32_t begin = first_polygon(number);
    const std::uint32_t end = first_polygon(number + 1);
    if (end < begin || first_atom(number + 1) < first_atom(number)) return false;
    if (first_byte_[number + 1] < first_byte_[number]) return false;
    if (begin < end && !begins_atom(begin)) return false;
    std::uint32_t atoms = 0;
    for (std::uint32_t polygon = begin; polygon < end; ++polygon) atoms += begins_atom(polygon) ? 1 : 0;
    if (atoms != atom_count(number)) return false;
  }
  return true;
}

bool polygon_orders::atom_begins(std::uint32_t number, std::span<std::uint32_t> out) const noexcept {
  if (number >= count_) return false;
  const std::uint32_t begin = first_polygon(number);
  const std::uint32_t end = first_polygon(number + 1);
  std::size_t found = 0;
  for (std::uint32_t polygon = begin; polygon < end; ++polygon) {
    if (!begins_atom(polygon)) continue;
    if (found == out.size()) return false;
    out[found++] = polygon - begin;
  }
  return found == out.size();
}

bool polygon_orders::source_of_stored(std::uint32_t number, std::span<std::uint32_t> out) const noexcept {
  if (number >= count_ || out.size() != polygon_count(number)) return false;
  bit_reader in(permutations_);
  in.seek(8 * std::uint64_t{first_byte_[number]});
  const std::uint64_t begin = first_polygon(number);
  std::uint32_t expected = 0;  // the polygon behind the one before
  for (std::size_t i = 0; i < out.size(); ++i) {
    const bool begins = begins_atom(begin + i);
    unsigned length = 0;
    const std::uint32_t symbol = (begins ? begins_ : follows_).decode(in.peek(), length);
    if (symbol == prefix_code::no_symbol) return false;
    in.skip(length);
    const std::uint32_t value = base_of(symbol) + in.take(raw_bits_of(symbol));
    // Behind the begin of an atom its polygons ascend; to a begin it may go down: odd values are steps back.
    const std::uint32_t step = begins ? value >> 1 ^ (0 - (value & 1u)) : value;
    out[i] = expected + step;
    if (out[i] >= out.size() || in.beyond_end()) return false;
    expected = out[i] + 1;
  }
  return true;
}

}  // namespace sightcell::format
