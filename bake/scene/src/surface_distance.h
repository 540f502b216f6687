#pragma once
// How far two surfaces are from each other, for cluster_dag.h.
#include <array>
#include <glm/vec3.hpp>
#include <span>

namespace sightcell::scene {

using surface_triangle = std::array<glm::vec3, 3>;

// Returns the greatest distance from a corner, the center of an edge or the center of a triangle of one surface to the
// other surface, both ways. Triangles that both surfaces have may be left out of `only_a` and `only_b`, the triangles
// that are measured from.
// a, b: all triangles of both surfaces; not empty, finite.
double surface_distance(std::span<const surface_triangle> a, std::span<const surface_triangle> only_a,
                        std::span<const surface_triangle> b, std::span<const surface_triangle> only_b);

}  // namespace sightcell::scene
