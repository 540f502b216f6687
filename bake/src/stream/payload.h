#pragma once
// Bytes of fronts and cell chunks (docs/streaming.md, "Numbers and columns").
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightcell::bake {

class payload {
 public:
  void put_bytes(std::span<const std::uint8_t> bytes);
  void put_u32(std::uint32_t value);
  void put_varint(std::uint32_t value);
  void put_varints(std::span<const std::uint32_t> values);
  // The difference to the previous value; at first to 0.
  void put_deltas(std::span<const std::uint32_t> values);
  // Ascending values.
  void put_gaps(std::span<const std::uint32_t> values);
  void put_floats(std::span<const float> values);
  void put(const payload& other) { put_bytes(other.bytes_); }

  std::span<const std::uint8_t> bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

// Returns a zlib stream.
std::vector<std::uint8_t> deflated(std::span<const std::uint8_t> bytes);

// The first bytes of a SHA-256, which name a file.
using content_name = std::array<std::uint8_t, 8>;
content_name name_of(std::span<const std::byte> file);

}  // namespace sightcell::bake
