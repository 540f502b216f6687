#pragma once
// The interface of all samplers, which find the polygons visible from a cell with hemicubes or rays.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>

#include "cell_set/cell_set.h"
#include "cells/view_cell.h"
#include "hemicube/hemicube_source.h"
#include "search/cell_search.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/box.h"
#include "sightcell/base/time_limit.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

class surface_colors;

// What samplers use. All of it must outlive the sampler.
struct sampler_world {
  const ray_scene& rays;
  hemicube_source& source;
  const surface_colors* colors = nullptr;  // required by importance-depth-color
  // Of the whole bake, for samplers whose rays contribute to every cell that they cross.
  std::span<const view_cell> cells = {};
  const near_polygons* neighbors = nullptr;  // required by guided
};

// The cell to sample.
struct sampled_cell {
  box grown;
  std::uint64_t place = 0;  // key of the random numbers of the cell
  bool geometry_inside = false;
  std::span<const glm::vec3> free;           // valid viewpoints of the region in a fixed order, at least one
  const viewpoint_region* region = nullptr;  // of the grown box, where viewpoints are drawn; null: all of it
  const time_limit* limit = nullptr;         // the sampler ends when it is reached; null: no limit

  viewpoint_region where() const { return region ? *region : viewpoint_region(grown); }
};

// What a call of sample() used.
struct sampling_effort {
  std::uint32_t samples = 0;  // hemicubes
  std::uint64_t rays = 0;
};

// Finds the polygons that are visible from a cell.
class cell_sampler {
 public:
  virtual ~cell_sampler() = default;
  // Does work for all cells. Called once before the first sample(), in the arena of the bake.
  // go_on: called with the share that is done, 0..1. If it returns false, the work ends, and sample() must not be
  // called.
  virtual void prepare(const std::function<bool(double share)>& go_on) { (void)go_on; }
  // Adds to set the polygons that it finds visible from the cell. The result depends on settings, world and cell
  // alone unless a time limit ends it. May be called from several threads at a time, each with its own set. Uses the
  // calling thread's TBB arena.
  virtual sampling_effort sample(const sampled_cell& cell, cell_set& set) const = 0;
  // Returns whether a device does the work, so that limits of time count wall-clock time and not that of a thread.
  virtual bool uses_device() const { return false; }
  // Returns hemicubes for a later search that continues after `taken` of them; nothing if the sampler does not
  // support that. cell.free may be empty.
  virtual std::optional<search_views> later_views(const sampled_cell& cell, std::uint32_t taken) const {
    (void)cell, (void)taken;
    return std::nullopt;
  }
};

// Returns the sampler how.sampler. Throws sightcell::error for an unknown name.
std::unique_ptr<cell_sampler> make_cell_sampler(const settings& how, const sampler_world& world);

}  // namespace sightcell::bake
