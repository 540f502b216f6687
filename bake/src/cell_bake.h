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

class cell_baker {
 public:
  // References must outlive the baker. neighbors: null when max_pixel_error is 0 (no rays).
  cell_baker(const settings& how, const ray_scene& rays, const near_polygons* neighbors, hemicube_source& source);

  // The record depends on settings, scene and the cell's box and place alone. Not thread-safe: one baker, one thread
  // (rays run on its TBB arena).
  cell_record bake(const view_cell& cell);

  bool geometry_inside() const { return geometry_inside_; }  // of the last cell

 private:
  const settings& how_;
  const ray_scene& rays_;
  const near_polygons* neighbors_;
  hemicube_source& source_;
  duplicate_classes duplicates_;
  cell_set set_;
  std::vector<std::uint32_t> always_;  // polygons that are in every set
  bool geometry_inside_ = false;
};

}  // namespace sightcell::bake
