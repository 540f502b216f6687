#pragma once
// Tables of u32 in few bits (SPEC.md, "Packed columns"): each column says its smallest value and how many bits the rest
// of a value has, so that any value is found at once. packed_columns_writer.h is the way back.
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::format {

class packed_columns {
 public:
  static constexpr std::uint64_t descriptor_size = 8;  // u32 smallest value, u32 bits

  // A table without columns.
  packed_columns() noexcept = default;
  // bytes: the table and nothing behind it, of so many columns with `rows` values each; viewed. False when the size is
  // not what the descriptors make it, or a column has more than 32 bits.
  [[nodiscard]] bool open(std::span<const std::byte> bytes, std::uint32_t columns, std::uint32_t rows) noexcept;
  // Size of the table that bytes begin with. False when they begin none, or it does not end inside them.
  [[nodiscard]] static bool size_of(std::span<const std::byte> bytes, std::uint32_t columns, std::uint32_t rows,
                                    std::uint64_t& size) noexcept;

  [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }

 private:
  friend class packed_column;
  std::span<const std::byte> bytes_;
  std::uint32_t columns_ = 0;
  std::uint32_t rows_ = 0;
};

// One column, with what finding a value needs: to be made once for many values.
class packed_column {
 public:
  packed_column() noexcept = default;
  // number: below the table's columns; another one makes a column of zeros.
  packed_column(const packed_columns& table, std::uint32_t number) noexcept;

  // Value of a row; wraps around at 2^32, as the sum of smallest value and bits does. 0 for a row there is not, and any
  // value when somebody changed the bytes.
  [[nodiscard]] std::uint32_t operator[](std::uint32_t row) const noexcept;

 private:
  std::span<const std::byte> bytes_;  // of the column
  std::uint32_t base_ = 0;
  unsigned bits_ = 0;
  std::uint32_t rows_ = 0;
};

}  // namespace sightcell::format
