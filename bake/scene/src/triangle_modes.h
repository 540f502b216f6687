#pragma once
// Converts lists, strips and fans of glTF to separate triangles.
#include <cstdint>
#include <vector>

namespace sightcell::scene {

inline constexpr int mode_triangles = 4, mode_triangle_strip = 5;  // numbers in glTF; 6 is a fan

// Returns three corners per triangle of a list, strip or fan of vertex indices. Every second triangle of a strip is
// turned so that all face the same way.
std::vector<std::uint32_t> to_triangles(std::vector<std::uint32_t> corners, int mode);

}  // namespace sightcell::scene
