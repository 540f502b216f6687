#pragma once
// Ways to draw a frame of a baked world.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/frames/clusters.h"
#include "bench/frames/stage.h"

namespace sightcell::bench {

class way {
 public:
  virtual ~way() = default;
  // What an engine does before it draws: asks for what is visible, leaves out what is not in the frustum, fills lists.
  virtual void cull(const frame_camera& camera) = 0;
  // The calls of OpenGL, after stage::begin.
  virtual void issue(stage& on) = 0;

  // Of the last frame.
  std::uint64_t polygons = 0;
  std::uint64_t draws = 0;  // pieces of index buffers, each a command of its own; a call may have many
  std::uint64_t calls = 0;
  bool changed = false;  // lists were made anew for another cell
  std::uint32_t flags = 0, cell = SIGHTCELL_NO_CELL;
};

struct cluster_sizes {
  std::uint32_t frustum = 256, sets = 256;  // polygons
};

struct named_way {
  std::string name;
  std::unique_ptr<way> how;
};

// full: a call per group. frustum: clusters in the frustum. pvs_commands: the ranges of the cell's set, as indirect
// commands that are filled when the cell changes. pvs_indices: its index list, likewise. pvs_frustum: the set sorted
// into clusters when the cell changes; each frame those of them that are in the frustum. References must outlive the
// ways.
std::vector<named_way> make_ways(const baked_world& world, const stage& on, const cluster_sizes& sizes);

}  // namespace sightcell::bench
