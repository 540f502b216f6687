#pragma once
// The vertices of a geometry as pages store them: rounded, each only once.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "gltf_attributes.h"
#include "sightcell/scene/scene.h"
#include "vertex_layout.h"

namespace sightcell::scene {

struct rounded_geometry {
  vertex_layout layout;
  std::uint32_t vertices = 0;
  std::vector<std::vector<std::uint8_t>> streams;  // by stream of the layout, with filters applied
  std::vector<std::uint32_t> corners;              // three vertices per polygon; equal ones if it is not drawn
  glm::vec3 min{0.0f}, max{0.0f};                  // of the rounded vertices

  bool is_drawn(std::uint32_t polygon) const;
};

// Steps as exponents of two.
struct rounding_steps {
  int positions = -12;
  int coordinates = -14;  // of textures
};

// Returns the largest exponent e for which 2^e is at most `step`.
int exponent_of(double step);

// Rounds a geometry. Steps grow where numbers would not fit 24 bits.
// values: its attributes in the rest pose.
rounded_geometry round_geometry(const geometry& g, const attribute_values& values, const rounding_steps& steps);

// Returns the position of a rounded vertex.
glm::vec3 position_of(const rounded_geometry& g, std::uint32_t vertex);

}  // namespace sightcell::scene
