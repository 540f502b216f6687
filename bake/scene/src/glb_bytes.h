#pragma once
// The container of a .glb file.
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace sightcell::scene {

// The longest .glb: lengths in one have 32 bits.
inline constexpr std::uint64_t longest_glb = std::numeric_limits<std::uint32_t>::max();

// Returns the length of a .glb. binary: bytes of its BIN chunk, a multiple of 4.
std::uint64_t glb_size(const std::string& json, std::uint64_t binary);

// Returns a .glb whose last `binary` bytes are its BIN chunk, all zero. glb_size() is at most longest_glb.
std::vector<std::byte> glb_with_room(std::string json, std::uint64_t binary);

}  // namespace sightcell::scene
