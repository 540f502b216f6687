#pragma once
// Small closed shapes at any angle, for things that are not axis-aligned.
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh.h"
#include "random.h"

namespace sightcell::city {

// Right-handed unit axes at a place.
struct frame {
  glm::dvec3 at{0, 0, 0};
  glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  // Vectors, so that calls can list random numbers in braces, which are drawn in order; arguments are not.
  glm::dvec3 point(const glm::dvec3& p) const { return at + x * p.x + y * p.y + z * p.z; }
  frame moved(const glm::dvec3& p) const { return {point(p), x, y, z}; }
};

// x lies along `along`, z is outward of a wall that has its inside to the left of it.
frame upright_frame(const glm::dvec3& at, const glm::dvec2& along);

// The same place turned about random axes: amount 0.1 leans a little, 1 and more tumbles.
frame tumbled(const frame& f, double amount, random_stream& random);

// Turned about the frame's own y by an angle whose half has this tangent.
frame turned(const frame& f, double half_tangent);

// 12 polygons; half: half edges.
void crate(mesh& m, surface material, const frame& f, const glm::dvec3& half);

// A closed prism, or cone where the end radius is 0, from a to b. sides: 3 (8 polygons), 4 (12) or 6 (20); as a cone 4,
// 6, 10.
void pillar(mesh& m, surface material, const glm::dvec3& a, const glm::dvec3& b, double radius, double end_radius,
            std::size_t sides);

// One quadrilateral around the frame's place, facing its z. 2 polygons.
void card(mesh& m, surface material, const frame& f, double half_width, double half_height);

}  // namespace sightcell::city
