#include "sightcell/format/packed_columns.h"

#include "checked_reader.h"

namespace sightcell::format {
namespace {

std::uint64_t column_size(std::uint32_t bits, std::uint32_t rows) noexcept {
  return (std::uint64_t{bits} * rows + 7) / 8;
}

struct descriptor {
  std::uint32_t base = 0;
  std::uint32_t bits = 0;
};

bool read_descriptor(const checked_reader& in, std::uint32_t column, descriptor& out) noexcept {
  const std::uint64_t at = column * packed_columns::descriptor_size;
  return in.read_u32(at, out.base) && in.read_u32(at + 4, out.bits) && out.bits <= 32;
}

}  // namespace

bool packed_columns::size_of(std::span<const std::byte> bytes, std::uint32_t columns, std::uint32_t rows,
                             std::uint64_t& size) noexcept {
  const checked_reader in(bytes);
  size = columns * descriptor_size;
  for (std::uint32_t c = 0; c < columns; ++c) {
    descriptor d;
    if (!read_descriptor(in, c, d)) return false;
    size += column_size(d.bits, rows);
  }
  return size <= bytes.size();
}

bool packed_columns::open(std::span<const std::byte> bytes, std::uint32_t columns, std::uint32_t rows) noexcept {
  std::uint64_t size = 0;
  if (!size_of(bytes, columns, rows, size) || size != bytes.size()) return false;
  bytes_ = bytes;
  columns_ = columns;
  rows_ = rows;
  return true;
}

packed_column::packed_column(const packed_columns& table, std::uint32_t number) noexcept {
  const checked_reader in(table.bytes_);
  std::uint64_t begin = table.columns_ * packed_columns::descriptor_size;
  descriptor d;
  for (std::uint32_t c = 0; c <= number; ++c) {
    if (c >= table.columns_ || !read_descriptor(in, c, d)) return;
    if (c < number) begin += column_size(d.bits, table.rows_);
  }
  const std::uint64_t size = column_size(d.bits, table.rows_);
  if (begin > table.bytes_.size() || size > table.bytes_.size() - begin) return;  // the descriptors changed since open
  bytes_ = table.bytes_.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(size));
  base_ = d.base;
  bits_ = d.bits;
  rows_ = table.rows_;
}

std::uint32_t packed_column::operator[](std::uint32_t row) const noexcept {
  if (row >= rows_) return 0;
  const checked_reader in(bytes_);
  const std::uint64_t begin = std::uint64_t{row} * bits_;
  const std::uint64_t end = begin + bits_;
  std::uint64_t value = 0;
  for (std::uint64_t at = begin / 8; 8 * at < end; ++at) {
    std::uint8_t byte = 0;
    if (!in.read_u8(at, byte)) return 0;
    value |= std::uint64_t{byte} << (8 * (at - begin / 8));
  }
  value = value >> (begin % 8) & ((std::uint64_t{1} << bits_) - 1);
  return base_ + static_cast<std::uint32_t>(value);
}

bool open_columns(std::span<const std::byte> bytes, std::uint32_t rows, std::span<packed_column> out) noexcept {
  const auto columns = static_cast<std::uint32_t>(out.size());
  packed_columns table;
  if (!table.open(bytes, columns, rows)) return false;
  for (std::uint32_t i = 0; i < columns; ++i) out[i] = packed_column(table, i);
  return true;
}

bool take_columns(std::span<const std::byte>& bytes, std::uint32_t rows, std::span<packed_column> out) noexcept {
  std::uint64_t size = 0;
  if (!packed_columns::size_of(bytes, static_cast<std::uint32_t>(out.size()), rows, size) ||
      !open_columns(bytes.first(static_cast<std::size_t>(size)), rows, out)) {
    return false;
  }
  bytes = bytes.subspan(static_cast<std::size_t>(size));
  return true;
}

}  // namespace sightcell::format
