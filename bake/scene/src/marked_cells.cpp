#include "marked_cells.h"

#include <glm/common.hpp>
#include <limits>
#include <map>
#include <string>

namespace sightcell::scene {
namespace {

// The axis-aligned box of points. NaN coordinates are ignored; a box without a point is infinite, and no cell.
struct world_box {
  glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};

  void add(const glm::dmat4& to_world, const glm::dvec3& local) {
    const glm::dvec3 p(to_world * glm::dvec4(local, 1.0));
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
};

void add_cell(scene& s, std::uint32_t node, const world_box& box) {
  marked_cell& cell = s.cells.emplace_back();
  cell.name = s.node_names[node];
  for (int axis = 0; axis < 3; ++axis) {
    cell.min[static_cast<std::size_t>(axis)] = static_cast<float>(box.min[axis]);
    cell.max[static_cast<std::size_t>(axis)] = static_cast<float>(box.max[axis]);
  }
}

}  // namespace

void add_marked_cells(scene& s, std::uint32_t node, const glm::dmat4& to_world, const std::size_t* first_draw) {
  if (first_draw == nullptr) {
    world_box cube;
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        for (const double z : {-1.0, 1.0}) cube.add(to_world, {x, y, z});
    add_cell(s, node, cube);
    return;
  }
  std::map<std::uint32_t, world_box> boxes;  // by instance: of all primitives
  for (std::size_t i = *first_draw; i < s.draws.size(); ++i) {
    const draw& d = s.draws[i];
    const geometry& g = s.geometries[d.geometry];
    for (const std::uint32_t vertex : g.indices) boxes[d.instance].add(d.to_world, glm::dvec3(g.positions[vertex]));
  }
  for (const auto& [instance, box] : boxes) add_cell(s, node, box);
  if (boxes.empty())
    s.warnings.push_back("nodes[" + std::to_string(node) +
                         "] is marked as a view cell, but its mesh has no triangles: it is no cell");
}

}  // namespace sightcell::scene
