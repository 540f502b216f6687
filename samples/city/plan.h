#pragma once
// The city in plan: a bent lattice of streets, blocks between them, lots for buildings along every block's edge.
#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "mesh.h"
#include "style.h"

namespace sightcell::city {

struct lot {
  ring footprint;                // edge 0 is the street front, edge 2 the back to the courtyard
  double front_setback = 0;      // meters behind the building line
  bool is_over_passage = false;  // the house begins above a covered passage into the yard
};

struct block {
  std::uint32_t row = 0, column = 0;
  ring tile;      // street nodes: its share of the ground
  ring pavement;  // raised slab
  ring outline;   // building line
  ring yard;      // what the buildings enclose; of a square: the whole place
  bool is_square = false;
  std::vector<lot> lots;
  bool is_sunken_low = false, is_sunken_high = false;  // the street at its low-z or high-z side
};

// A stretch of street between two neighboring nodes.
struct street {
  glm::dvec2 from, to;
  double width = 0;  // between building lines
  bool is_sunken = false;
};

// Carries a street over a sunken one. From the sunken street's one wall over the crossing to its other wall.
struct bridge {
  glm::dvec2 from, over, to;
  double width = 0;
};

struct plan {
  std::uint32_t rows = 0, columns = 0;
  std::vector<glm::dvec2> nodes;  // (rows + 3) x (columns + 3): the crossings and one ring of ground around them
  std::vector<block> blocks;      // row by row
  std::vector<street> streets;
  std::vector<glm::dvec2> crossings;  // but those under bridges
  std::vector<bridge> bridges;

  const glm::dvec2& node(std::uint32_t row, std::uint32_t column) const { return nodes[row * (columns + 3) + column]; }
};

inline constexpr double slab_height = 0.12;
inline constexpr double building_base = -0.1;  // buildings reach below the slab they stand on

// The outermost nodes in up order: where the town wall stands.
std::vector<glm::dvec2> rim_of(const plan& p);

plan make_plan(std::uint32_t rows, std::uint32_t columns, std::uint64_t seed, const plan_style& style = {});

}  // namespace sightcell::city
