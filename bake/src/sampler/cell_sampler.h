#pragma once
// The one interface of all samplers: what a cell sees, found by hemicubes or by rays.
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
#include "trace/ray_scene.h"

namespace sightcell::bake {

class surface_colors;

// What a sampler looks into. All of it must outlive the sampler.
struct sampler_world {
  const ray_scene& rays;
  hemicube_source& source;
  const surface_colors* colors = nullptr;    // of importance-depth-color, which cannot do without
  std::span<const view_cell> cells = {};     // of the whole bake, for samplers whose rays feed all that they cross
  const near_polygons* neighbors = nullptr;  // of guided, which cannot do without
};

struct sampled_cell {
  box grown;
  std::uint64_t place = 0;  // names its random numbers
  bool geometry_inside = false;
  std::span<const glm::vec3> free;  // free points of the grown box in a fixed order, one at least
};

struct sampling_effort {
  std::uint32_t samples = 0;  // hemicubes
  std::uint64_t rays = 0;
};

class cell_sampler {
 public:
  virtual ~cell_sampler() = default;
  // Called once before the first sample(), on the arena of the bake. share: of this work that is done, 0..1; false ends
  // it early, and then nothing may be sampled.
  virtual void prepare(const std::function<bool(double share)>& go_on) { (void)go_on; }
  // Adds to set what the cell sees. The result depends on settings, world and cell alone, except where a limit of time
  // ends it. May be called from several threads at a time, each with a set of its own, where the source is shared();
  // works on the calling thread's TBB arena.
  virtual sampling_effort sample(const sampled_cell& cell, cell_set& set) const = 0;
  // Hemicubes for the search that goes on after `taken` of them; nothing where this sampler looks no further.
  // cell.free may be empty.
  virtual std::optional<search_views> later_views(const sampled_cell& cell, std::uint32_t taken) const {
    (void)cell, (void)taken;
    return std::nullopt;
  }
};

// By how.sampler. Throws sightcell::error for an unknown name.
std::unique_ptr<cell_sampler> make_cell_sampler(const settings& how, const sampler_world& world);

}  // namespace sightcell::bake
