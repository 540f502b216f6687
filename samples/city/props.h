#pragma once
// Things that stand in the city more than once: one mesh each, placed by nodes.
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "mesh.h"

namespace sightcell::city {

enum class prop : std::uint8_t {
  small_tree,
  round_tree,
  broad_tree,
  conifer,
  lamp,
  bench,
  car,
  stall,
  fountain,
  crate,
  // Only in the richer styles:
  leafy_tree,
  young_tree,
  bush,
  bicycle,
  cafe_table,
  motor_car,
  street_lamp,
  fruit_stall,
  barrow,
  count
};

std::vector<mesh> make_prop_meshes(std::uint64_t seed);       // by prop number, as far as the plain town needs them
std::vector<mesh> make_town_prop_meshes(std::uint64_t seed);  // all

struct prop_place {
  prop kind = prop::lamp;
  glm::dvec2 at{0, 0};
  glm::dvec2 turn{0, 1};  // y and w of the rotation's unit quaternion
  double scale = 1.0;
  double base = 0.12;     // height of the ground it stands on
  glm::dvec2 tilt{0, 0};  // x and z of the quaternion
};

double prop_radius(prop kind);  // meters around its place that it may take

}  // namespace sightcell::city
