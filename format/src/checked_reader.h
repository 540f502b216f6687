#pragma once
// The only file that converts bytes of a file to integers: little-endian, bounds-checked, any alignment. Each byte is
// loaded through volatile, exactly once per call, so that the compiler cannot load a value again after it was checked:
// a file in shared memory may change at any moment.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace sightcell::format {

// Reads fixed-size numbers at given offsets. Returns false, and leaves out unchanged, for an offset outside the bytes.
class checked_reader {
 public:
  explicit checked_reader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  [[nodiscard]] bool read_u8(std::uint64_t offset, std::uint8_t& out) const noexcept { return read(offset, out); }
  [[nodiscard]] bool read_u32(std::uint64_t offset, std::uint32_t& out) const noexcept { return read(offset, out); }
  [[nodiscard]] bool read_u64(std::uint64_t offset, std::uint64_t& out) const noexcept { return read(offset, out); }

  [[nodiscard]] bool read_f32(std::uint64_t offset, float& out) const noexcept {
    std::uint32_t bits = 0;
    if (!read(offset, bits)) return false;
    out = std::bit_cast<float>(bits);
    return true;
  }
  [[nodiscard]] bool read_f64(std::uint64_t offset, double& out) const noexcept {
    std::uint64_t bits = 0;
    if (!read(offset, bits)) return false;
    out = std::bit_cast<double>(bits);
    return true;
  }

 private:
  template <class Unsigned>
  [[nodiscard]] bool read(std::uint64_t offset, Unsigned& out) const noexcept {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(Unsigned)) return false;
    const volatile std::byte* place = bytes_.data() + offset;
    std::uint64_t value = 0;
    for (unsigned i = 0; i < sizeof(Unsigned); ++i) value |= static_cast<std::uint64_t>(place[i]) << (8 * i);
    out = static_cast<Unsigned>(value);
    return true;
  }

  std::span<const std::byte> bytes_;
};

// Reads numbers of variable length, one after the other: 7 bits per byte, lowest first; the top bit is set if more
// follow.
class varint_cursor {
 public:
  varint_cursor() noexcept = default;
  explicit varint_cursor(std::span<const std::byte> bytes) noexcept
      : place_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  // False at the end of the bytes, for a number above 32 bits, and for one that has a shorter form: one value, one
  // encoding.
  [[nodiscard]] bool read(std::uint32_t& out) noexcept {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      if (place_ == end_) return false;
      const auto byte = static_cast<std::uint32_t>(*place_++);
      if (shift == 28 && byte > 0x0F) return false;
      value |= (byte & 0x7Fu) << shift;
      if (byte < 0x80u) {
        out = value;
        return byte != 0 || shift == 0;
      }
    }
    return false;
  }

  [[nodiscard]] bool at_end() const noexcept { return place_ == end_; }
  [[nodiscard]] std::size_t left() const noexcept { return static_cast<std::size_t>(end_ - place_); }

  // Moves the next size bytes into a cursor of their own. False if there are fewer.
  [[nodiscard]] bool split(std::size_t size, varint_cursor& head) noexcept {
    if (size > left()) return false;
    head.place_ = place_;
    head.end_ = place_ + size;
    place_ += size;
    return true;
  }

 private:
  const volatile std::byte* place_ = nullptr;
  const volatile std::byte* end_ = nullptr;
};

}  // namespace sightcell::format
