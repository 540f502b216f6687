#pragma once
// The counterpart of bit_reader.h: appends bits to bytes, lowest bit of a byte first.
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sightcell::format {

class bit_sink {
 public:
  // out belongs to the caller; bits are appended to it.
  explicit bit_sink(std::vector<std::byte>& out) noexcept : out_(out) {}

  // Appends the lowest `bits` (0 .. 32) of value.
  void put(std::uint32_t value, unsigned bits) {
    held_ |= (std::uint64_t{value} & ((std::uint64_t{1} << bits) - 1)) << held_bits_;
    held_bits_ += bits;
    for (; held_bits_ >= 8; held_bits_ -= 8, held_ >>= 8) out_.push_back(static_cast<std::byte>(held_ & 0xFFu));
  }
  // Fills the last byte with zeros. Called once after the last bit, and wherever a whole byte must begin.
  void align() {
    if (held_bits_ == 0) return;
    out_.push_back(static_cast<std::byte>(held_ & 0xFFu));
    held_ = 0;
    held_bits_ = 0;
  }

 private:
  std::vector<std::byte>& out_;
  std::uint64_t held_ = 0;
  unsigned held_bits_ = 0;
};

}  // namespace sightcell::format
