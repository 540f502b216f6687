#pragma once
// Numbers and names that glTF gives to types.
#include <cstdint>

namespace sightcell::scene {

inline constexpr int byte_type = 5120, unsigned_byte_type = 5121, unsigned_short_type = 5123, unsigned_int_type = 5125,
                     float_type = 5126;
inline constexpr int array_buffer = 34962, element_array_buffer = 34963;

// Returns the bytes of a component.
constexpr std::uint32_t size_of_type(int component_type) {
  return component_type <= unsigned_byte_type ? 1 : component_type <= unsigned_short_type ? 2 : 4;
}

// Returns the name of a vector of 2, 3 or 4 numbers.
inline const char* vector_type(std::uint32_t width) {
  return width == 2 ? "VEC2" : width == 3 ? "VEC3" : "VEC4";
}

}  // namespace sightcell::scene
