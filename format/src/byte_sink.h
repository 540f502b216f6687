#pragma once
// The only file that converts integers to bytes of a file: little-endian, appended to a vector.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::format {

class byte_sink {
 public:
  explicit byte_sink(std::vector<std::byte>& out) noexcept : out_(out) {}

  void put_u8(std::uint8_t value) { put(value, 1); }
  void put_u32(std::uint32_t value) { put(value, 4); }
  void put_u64(std::uint64_t value) { put(value, 8); }
  void put_f32(float value) { put(std::bit_cast<std::uint32_t>(value), 4); }
  void put_f64(double value) { put(std::bit_cast<std::uint64_t>(value), 8); }
  void put_bytes(std::span<const std::byte> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }

 private:
  void put(std::uint64_t value, unsigned size) {
    for (unsigned i = 0; i < size; ++i) out_.push_back(static_cast<std::byte>(value >> (8 * i) & 0xFFu));
  }

  std::vector<std::byte>& out_;
};

}  // namespace sightcell::format
