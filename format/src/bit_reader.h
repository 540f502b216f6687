#pragma once
// Bits of a chunk, lowest bit of a byte first, as far as 56 at a time. Bytes are taken as hostile, and somebody may
// change them while they are read: each load is at a checked place, and no two loads of the same place are relied on to
// agree.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace sightcell::format {

class bit_reader {
 public:
  // Bytes that must follow the last bit, so that a load never needs to look where it is.
  static constexpr std::size_t padding = 8;
  // Bits that one peek is good for.
  static constexpr unsigned peek_bits = 56;

  // A reader of nothing.
  bit_reader() noexcept = default;
  // bytes: the bits and the padding behind them. Fewer bytes than padding: no bits.
  explicit bit_reader(std::span<const std::byte> bytes) noexcept
      : bytes_(bytes.data()), end_(bytes.size() < padding ? 0 : 8 * std::uint64_t{bytes.size() - padding}) {
    if (bytes.size() < padding) bytes_ = nullptr;
  }

  // Bits from the start of the bytes. A reader that was moved beyond its end stays there, and peeks zeros.
  [[nodiscard]] std::uint64_t place() const noexcept { return place_; }
  [[nodiscard]] bool beyond_end() const noexcept { return place_ > end_; }

  // The next 56 bits or more, lowest first; what is behind the end is anything.
  [[nodiscard]] std::uint64_t peek() const noexcept {
    if (place_ > end_ || bytes_ == nullptr) return 0;
    return load(bytes_ + (place_ >> 3)) >> (place_ & 7u);
  }
  void skip(unsigned bits) noexcept { place_ += bits; }
  void seek(std::uint64_t place) noexcept { place_ = place; }

  // The next `bits` (0 .. 32) as a number. Beyond the end: anything, and beyond_end() says so.
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

// The same bits for loops that take some in each round: 56 or more lie in a word after each fill().
class bit_buffer {
 public:
  // From the reader's place on.
  explicit bit_buffer(const bit_reader& from) noexcept
      : begin_(from.bytes_), last_(from.bytes_ == nullptr ? nullptr : from.bytes_ + from.end_ / 8) {
    if (begin_ == nullptr || from.beyond_end()) return;
    at_ = begin_ + from.place_ / 8;
    fill();
    skip(static_cast<unsigned>(from.place_ % 8));
  }

  // Behind the last byte zeros follow, and place() lies beyond the end.
  void fill() noexcept {
    if (at_ == nullptr || at_ > last_) [[unlikely]] {
      fill_behind_end();
      return;
    }
    held_ |= bit_reader::load(at_) << held_bits_;
    at_ += (63u - held_bits_) >> 3;
    held_bits_ |= 56u;
  }
  // Lowest first; those that fill() promised.
  [[nodiscard]] std::uint64_t bits() const noexcept { return held_; }
  // How many that are; of what lies above them nothing is known.
  [[nodiscard]] unsigned left() const noexcept { return held_bits_; }
  // At most as many as are left.
  void skip(unsigned bits) noexcept {
    held_ >>= bits;
    held_bits_ -= bits;
  }
  // Of the next bit, as bit_reader counts.
  [[nodiscard]] std::uint64_t place() const noexcept {
    return 8 * static_cast<std::uint64_t>(at_ - begin_) + missing_ - held_bits_;
  }

 private:
  void fill_behind_end() noexcept {
    missing_ += (63u - held_bits_) & ~7u;
    held_bits_ |= 56u;
  }

  const std::byte* begin_ = nullptr;
  const std::byte* last_ = nullptr;  // the last place a whole word can be loaded from
  const std::byte* at_ = nullptr;
  std::uint64_t missing_ = 0;  // bits that were made up behind the end
  std::uint64_t held_ = 0;
  unsigned held_bits_ = 0;
};

}  // namespace sightcell::format
