#pragma once
// Finds where in a view cell the valid viewpoints are.
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

// The valid viewpoints of a view cell.
struct cell_viewpoints {
  viewpoint_region region;   // of the grown box; the whole box where valid viewpoints are common
  double valid_share = 1.0;  // estimated share of the region that is valid
  // Upper limit (95 % confidence) of the share of the cell's valid viewpoints that lie outside the region; 0 for the
  // whole box.
  double outside_share = 0.0;
  std::vector<glm::vec3> viewpoints;  // uniform over the valid points of the region, at least one
  std::vector<glm::vec3> own;         // valid viewpoints of the view cell itself, at least one
};

// What is explored.
struct explored_cell {
  box own;                   // the view cell
  box grown;                 // with its margin
  float radius = 0.05f;      // player radius, meters
  std::size_t wanted = 128;  // number of viewpoints
};

// Draws viewpoints. Where fewer than a quarter of the points of the grown box are valid, first finds the region: it
// tests points all over the box, makes a k-d tree of them whose leaves are mostly valid or have no valid point, tests
// more points in the leaves that are kept, and splits them again. Then it tests points in all that is left out, adds
// what it finds, and bounds the rest with fresh points.
// random: advanced by the points drawn.
// tests: increased by the number of points tested. At most about 40,000, most of them of points inside solids, which
// are cheap.
// Returns nothing if less than about 1/2048 of the view cell itself is valid, or less than about 1/32 of the region:
// such a cell lies in a wall or beyond the border of the scene.
std::optional<cell_viewpoints> explore_viewpoints(const ray_scene& rays, const explored_cell& cell,
                                                  random_stream& random, std::uint64_t& tests);

}  // namespace sightcell::bake
