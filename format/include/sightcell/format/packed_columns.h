#pragma once
// Tables of u32 in few bits (SPEC.md, "Packed columns"): a column stores its smallest value and, for each row, the
// difference to it in a fixed number of bits. So each value is found in constant time. The counterpart for writing is
// packed_columns_writer.h.
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::format {

class packed_columns {
 public:
  static constexpr std::uint64_t descriptor_size = 8;  // u32 smallest value, u32 bits

  // A table without columns.
  packed_columns() noexcept = default;

  // Opens a table. bytes: the table and nothing after it; not copied. columns, rows: its shape. False if the size does
  // not match the descriptors, or a column has more than 32 bits.
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t columns, std::uint32_t rows) noexcept;

  // The size of the table at the begin of bytes. False if there is no valid table, or it does not end inside bytes.
  [[nodiscard]] static bool size_of(std::span<const std::byte> bytes, std::uint32_t columns, std::uint32_t rows,
                                    std::uint64_t& size) noexcept;

  [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }

 private:
  friend class packed_column;
  std::span<const std::byte> bytes_;
  std::uint32_t columns_ = 0;
  std::uint32_t rows_ = 0;
};

// One column, with everything that a lookup needs: made once for many lookups.
class packed_column {
 public:
  packed_column() noexcept = default;

  // number: below the table's columns; for another one the column has only zeros.
  packed_column(const packed_columns& table, std::uint32_t number) noexcept;

  // The value of a row, modulo 2^32. 0 for a row that does not exist; any value if the bytes changed.
  [[nodiscard]] std::uint32_t operator[](std::uint32_t row) const noexcept;

 private:
  std::span<const std::byte> bytes_;  // of the column
  std::uint32_t base_ = 0;
  unsigned bits_ = 0;
  std::uint32_t rows_ = 0;
};

// Opens all columns of a table: out has one for each. bytes, rows, result: as for packed_columns::open.
[[nodiscard]] bool open_columns(std::span<const std::byte> bytes, std::uint32_t rows,
                                std::span<packed_column> out) noexcept;

// Opens the columns of a table at the begin of bytes and takes it from them. rows, result: as for packed_columns::open.
[[nodiscard]] bool take_columns(std::span<const std::byte>& bytes, std::uint32_t rows,
                                std::span<packed_column> out) noexcept;

}  // namespace sightcell::format
