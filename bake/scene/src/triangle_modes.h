#pragma once
// Lists, strips and fans of glTF as plain triangles.
#include <cstdint>
#include <vector>

namespace sightcell::scene {

inline constexpr int mode_triangles = 4, mode_triangle_strip = 5;  // glTF's numbers; 6 is a fan

// Three corners per triangle, from a list, strip or fan of vertex numbers; odd triangles of a strip are turned so that
// all face the same way.
std::vector<std::uint32_t> to_triangles(std::vector<std::uint32_t> corners, int mode);

}  // namespace sightcell::scene
