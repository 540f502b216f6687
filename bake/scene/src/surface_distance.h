#pragma once
// How far two surfaces are from each other, for cluster_dag.h.
#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace sightcell::scene {

struct surface_triangle {
  std::array<glm::vec3, 3> corners{};
  std::array<glm::vec2, 3> uvs{};  // texture coordinates; all equal where there are none
};

// Returns the greatest distance from a corner, the center of an edge or the center of a triangle of one surface to the
// other surface, both ways. A distance is that to the nearest point, and from there along the surface to the point with
// the same texture coordinates: the least sum of both over all triangles. So it is an estimate of how far the texture
// moves too; infinite where the other surface has one texture coordinate, and it is another one. Triangles that both
// surfaces have may be left out of `only_a` and `only_b`, the triangles that are measured from.
// a, b: all triangles of both surfaces; not empty, finite.
double surface_distance(std::span<const surface_triangle> a, std::span<const surface_triangle> only_a,
                        std::span<const surface_triangle> b, std::span<const surface_triangle> only_b);

}  // namespace sightcell::scene
