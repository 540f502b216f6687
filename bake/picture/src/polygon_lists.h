#pragma once
// Index lists in drawing order: polygons with the same state are contiguous, so that a picture of any set of polygons
// takes one draw call per state.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::picture {

// The state of polygons that are drawn together.
struct draw_group {
  scene::alpha_mode alpha = scene::alpha_mode::opaque;
  bool double_sided = false;
  std::uint32_t material = scene::no_index;
};

// A part of an index list.
struct index_range {
  std::uint32_t group = 0;
  std::uint32_t first = 0, count = 0;  // in indices
};

// Lists the polygons of a picture.
class polygon_lists {
 public:
  // References must outlive the object.
  polygon_lists(const scene::scene& s, const scene::world_geometry& geometry);

  // Returns the groups: opaque, then mask, then blend, because blended polygons need the others behind them.
  const std::vector<draw_group>& groups() const { return groups_; }

  // Lists the polygons with these source ids, or all; absent polygons are left out. Inside a group the order is that
  // of source_ids, so a subset is drawn in the same order as the whole scene. Throws sightcell::error if an id is not
  // in the scene.
  void gather(std::optional<std::span<const std::uint32_t>> source_ids, std::vector<std::uint32_t>& indices,
              std::vector<index_range>& ranges) const;

 private:
  const scene::world_geometry& geometry_;
  std::vector<draw_group> groups_;
  std::vector<std::uint32_t> group_of_;  // by source id; no_index for absent polygons
};

}  // namespace sightcell::picture
