#pragma once
// Reads the bits of a chunk, lowest bit of a byte first, up to 56 at a time. Safe for hostile bytes that may change
// while they are read: each load is at a checked offset, and two loads from the same offset need not agree.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace sightcell::format {

class bit_reader {
 public:
  // Bytes that must follow the last bit, so that a load needs no test against the end.
  static constexpr std::size_t padding = 8;
  // Bits that one peek returns.
  static constexpr unsigned peek_bits = 56;

  // A reader without bits.
  bit_reader() noexcept = default;
  // bytes: the bits, then the padding. Fewer bytes than padding: no bits.
  explicit bit_reader(std::span<const std::byte> bytes) noexcept
      : bytes_(bytes.data()), end_(bytes.size() < padding ? 0 : 8 * std::uint64_t{bytes.size() - padding}) {
    if (bytes.size() < padding) bytes_ = nullptr;
  }

  // Bits from the start of the bytes. A reader that was moved beyond its end stays there, and peeks zeros.
  [[nodiscard]] std::uint64_t place() const noexcept { return place_; }
  [[nodiscard]] bool beyond_end() const noexcept { return place_ > end_; }

  // The next 56 bits or more, lowest first. Bits after the end are undefined.
  [[nodiscard]] std::uint64_t peek() const noexcept {
    if (place_ > end_ || bytes_ == nullptr) return 0;
    return load(bytes_ + (place_ >> 3)) >> (place_ & 7u);
  }
  void skip(unsigned bits) noexcept { place_ += bits; }
  void seek(std::uint64_t place) noexcept { place_ = place; }

  // Takes the next `bits` (0 .. 32) as a number. Beyond the end: any number, and beyond_end() is true.
  std::uint32_t take(unsigned bits) noexcept {
    const std::uint64_t value = peek() & ((std::uint64_t{1} << bits) - 1);
    skip(bits);
    return static_cast<std::uint32_t>(value);
  }

 private:
  friend class bit_buffer;

  static std::uint64_t load(const std::byte* place) noexcept {
    std::uint64_t value = 0;
    if constexpr (std::endian::native == std::endian::little) {
      std::memcpy(&value, place, sizeof value);
    } else {
      for (unsigned i = 0; i < 8; ++i) value |= std::uint64_t{static_cast<std::uint8_t>(place[i])} << (8 * i);
    }
    return value;
  }

  const std::byte* bytes_ = nullptr;
  std::uint64_t end_ = 0;
  std::uint64_t place_ = 0;
};

// The same bits for loops that take some in each round: after each fill(), a word has 56 or more.
class bit_buffer {
 public:
  // Starts at the position of the reader.
  explicit bit_buffer(const bit_reader& from) noexcept
      : begin_(from.bytes_), last_(from.bytes_ == nullptr ? nullptr : from.bytes_ + from.end_ / 8) {
    if (begin_ == nullptr || from.beyond_end()) return;
    at_ = begin_ + from.place_ / 8;
    fill();
    skip(static_cast<unsigned>(from.place_ % 8));
  }

  // After the last byte zeros follow, and place() is beyond the end.
  void fill() noexcept {
    if (at_ == nullptr || at_ > last_) [[unlikely]] {
      fill_behind_end();
      return;
    }
    held_ |= bit_reader::load(at_) << held_bits_;
    at_ += (63u - held_bits_) >> 3;
    held_bits_ |= 56u;
  }
  // The next bits, lowest first; left() of them are valid.
  [[nodiscard]] std::uint64_t bits() const noexcept { return held_; }
  // The number of valid bits. Bits above them are undefined.
  [[nodiscard]] unsigned left() const noexcept { return held_bits_; }
  // bits: up to left().
  void skip(unsigned bits) noexcept {
    held_ >>= bits;
    held_bits_ -= bits;
  }
  // The position of the next bit, as in bit_reader.
  [[nodiscard]] std::uint64_t place() const noexcept {
    return 8 * static_cast<std::uint64_t>(at_ - begin_) + missing_ - held_bits_;
  }

 private:
  void fill_behind_end() noexcept {
    missing_ += (63u - held_bits_) & ~7u;
    held_bits_ |= 56u;
  }

  const std::byte* begin_ = nullptr;
  const std::byte* last_ = nullptr;  // the last offset from which a whole word can be loaded
  const std::byte* at_ = nullptr;
  std::uint64_t missing_ = 0;  // zero bits that were supplied after the end
  std::uint64_t held_ = 0;
  unsigned held_bits_ = 0;
};

}  // namespace sightcell::format
