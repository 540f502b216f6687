#pragma once
// Small things that are built into the mesh of what they hang on: on walls, roofs, in streets. Each kind has a fixed
// number of polygons; where it sits, how it leans and what it looks like come from its place and seed.
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh.h"

namespace sightcell::city {

enum class clutter : std::uint8_t {
  // on houses
  dentils,
  shutters,
  flower_box,
  door_things,
  wall_lamp,
  downpipe,
  gutter,
  hanging_sign,
  awning,
  wall_cable,
  loose_tiles,
  ridge_tiles,
  antenna,
  chimney_pots,
  rosettes,
  grille,
  scaffold,
  // in streets and yards
  wire,
  fruit_crate,
  litter,
  stones,
  fallen_leaves,
  leaf,
  pigeons,
  railing,
  planks,
  bottles,
  drain,
  // on towers
  bay_panels,
  bay_window,
  air_conditioner,
  balcony,
  laundry,
  pipe,
  stain,
  vent,
  cage,
  shop_sign,
  ledge,
  count
};

struct clutter_place {
  clutter kind = clutter::leaf;
  glm::dvec3 at{0, 0, 0};
  glm::dvec2 along{1, 0};  // unit; on a wall: to the right as seen from outside
  double size = 1.0;       // a length in meters where the kind stretches, else unused
  std::uint64_t seed = 0;
};

std::uint64_t clutter_cost(clutter kind);
double clutter_reach(clutter kind);  // meters around its place in plan that it may take; without `size`
void build_clutter(mesh& m, const clutter_place& place);

}  // namespace sightcell::city
