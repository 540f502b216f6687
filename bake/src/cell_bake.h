#pragma once
// One cell from start to end: free places, hemicubes, polygons inside, rays.
#include <cstdint>
#include <vector>

#include "cell_set.h"
#include "cells/view_cell.h"
#include "checkpoint.h"
#include "finish/near_polygons.h"
#include "rays/ray_scene.h"
#include "sightcell/bake/settings.h"
#include "source/hemicube_source.h"

namespace sightcell::bake {

struct baked_cell {
  cell_record record;
  bool geometry_inside = false;
};

class cell_baker {
 public:
  // References must outlive the baker. neighbors: null when max_pixel_error is 0 (no rays).
  cell_baker(const settings& how, const ray_scene& rays, const near_polygons* neighbors, hemicube_source& source);
  cell_baker(const cell_baker&) = delete;  // sets point into it
  cell_baker& operator=(const cell_baker&) = delete;

  // A set to work in, for one cell at a time. Takes set_bytes(), so it is made once and used for many cells.
  cell_set make_set() const;
  std::size_t set_bytes() const;

  // The record depends on settings, scene and the cell's box and place alone. set is overwritten. May be called from
  // several threads at a time, each with a set of its own, where the source is shared(). Works on the calling thread's
  // TBB arena.
  baked_cell bake(const view_cell& cell, cell_set& set) const;

 private:
  const settings& how_;
  const ray_scene& rays_;
  const near_polygons* neighbors_;
  hemicube_source& source_;
  duplicate_classes duplicates_;
  std::vector<std::uint32_t> always_;  // polygons that are in every set
};

}  // namespace sightcell::bake
