#pragma once
// The records of tables of meshlets: docs/meshlets.md defines their bytes.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

inline constexpr std::uint32_t meshlet_record_bytes = 64;

// Little-endian numbers, one after the other.
class byte_writer {
 public:
  explicit byte_writer(std::span<std::byte> into) : into_(into) {}

  void put(std::uint32_t value) {
    for (int k = 0; k < 4; ++k) into_[at_++] = static_cast<std::byte>(value >> (8 * k));
  }
  void put(float value) {
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    put(bits);
  }
  template <std::size_t N>
  void put(const float (&values)[N]) {
    for (const float value : values) put(value);
  }

 private:
  std::span<std::byte> into_;
  std::size_t at_ = 0;
};

struct meshlet_place {
  std::uint32_t group = 0, first_index = 0;
};

// Writes the record of a meshlet.
// corners: three vertices of g per triangle.
// bounded: false for what deforms: it may be anywhere.
// has_cone: false for what is visible from both sides.
void put_meshlet(byte_writer& out, const meshlet_place& place, const geometry& g,
                 std::span<const std::uint32_t> corners, bool bounded, bool has_cone);

}  // namespace sightcell::scene
