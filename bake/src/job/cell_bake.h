#pragma once
// One cell from start to end: free places, hemicubes, polygons inside, what neighbors see, rays.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bound/metric.h"
#include "cell_set/cell_record.h"
#include "cell_set/cell_set.h"
#include "cells/overrides.h"
#include "cells/view_cell.h"
#include "misses/reported_misses.h"
#include "sampler/cell_sampler.h"
#include "search/certify.h"
#include "search/near_polygons.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

// How far a cell is brought at a time where a time budget is spent on all of them by turns.
struct cell_turn {
  double target = 1e-2;        // its bound is to be at most this
  std::uint64_t max_rays = 0;  // or so many have been spent on it
  const time_limit* limit = nullptr;
};

// A record depends on settings, scene, the cell's box and place, and the records it is given, alone. In all calls set
// is a place to work in and is overwritten: it takes set_bytes(), so it is made once and used for many cells. All may
// be called from several threads at a time, each with a set of its own, where the source is shared(), and work on the
// calling thread's TBB arena.
class cell_baker {
 public:
  // References must outlive the baker. neighbors: may be null when max_pixel_error is 0 (no rays) and no safety ring is
  // asked for. sampler: prepared. metric: that of how. misses: null, none are known.
  // own_polygons: from there on they are of another scene and in no set (two_scenes.h). volumes: that rays look for,
  // too; null: none.
  cell_baker(const settings& how, const overrides& given, const ray_scene& rays, const near_polygons* neighbors,
             const cell_sampler& sampler, const error_metric& metric = pixel_metric,
             const reported_misses* misses = nullptr, std::uint32_t own_polygons = 0xFFFFFFFFu,
             const volume_grid* volumes = nullptr);
  cell_baker(const cell_baker&) = delete;  // sets point into it
  cell_baker& operator=(const cell_baker&) = delete;

  cell_set make_set() const;
  std::size_t set_bytes() const;

  // Phase 1, round 0: what the cell finds by itself, with hemicubes and the polygons inside.
  cell_record sample(const view_cell& cell, cell_set& set) const;
  // Phase 1, round 1: what its block's neighbors had found after round 0 is tried first, then rays find what pixels
  // missed, until fresh ones bound what is left.
  cell_record finish_rays(const view_cell& cell, const cell_record& own, std::span<const cell_record> neighbors,
                          cell_set& set) const;
  // Both rounds of a cell that no other is in the block of.
  cell_record sample_and_finish(const view_cell& cell, cell_set& set) const;
  // Phase 2: what neighbors of all blocks have found after phase 1 is tried. Adds only, so the bound still holds.
  // limit: null, none.
  cell_record check(const view_cell& cell, const cell_record& own, std::span<const cell_record> neighbors,
                    cell_set& set, const time_limit* limit = nullptr) const;
  // The next turn of a cell, or its first: before is null. What neighbors have found by now is tried first. The set
  // grows and the bound falls, or both are what they were.
  cell_record improve(const view_cell& cell, const cell_record* before, std::span<const cell_record> neighbors,
                      const cell_turn& turn, cell_set& set) const;
  // From the last of these to a finished cell: overrides of the cells file, coarser levels of detail and the safety
  // ring join.
  cell_record finished(const view_cell& cell, cell_record last) const;

  // Do cells see what others found? Not where the sampler is alone.
  bool shares() const { return how_.max_pixel_error > 0.0; }

 private:
  box grown(const view_cell& cell) const { return box{cell.min, cell.max}.grown(how_.margin); }
  bool find_viewpoints(const view_cell& cell, std::vector<glm::vec3>& free, double& valid_share) const;
  void add_inside(const view_cell& cell, const std::vector<std::uint32_t>& inside, const std::vector<glm::vec3>& free,
                  cell_set& set) const;
  void add_misses(const view_cell& cell, cell_set& set, cell_record& record) const;
  void complete(const view_cell& cell, std::vector<std::uint32_t>& set) const;
  std::optional<search_views> views_of(const view_cell& cell, const cell_record& record) const;
  finish_result finish(const view_cell& cell, finish_settings how, std::optional<search_views>& views, cell_set& set,
                       cell_record& record) const;
  void bound(const view_cell& cell, std::size_t known, cell_set& set, cell_record& record) const;

  const settings& how_;
  const overrides& given_;
  const ray_scene& rays_;
  const near_polygons* neighbors_;
  const cell_sampler& sampler_;
  const error_metric& metric_;
  const reported_misses* misses_;
  const std::uint32_t own_polygons_;
  const volume_grid* volumes_;
  duplicate_classes duplicates_;
  std::vector<std::uint32_t> always_;  // polygons that are in every set
};

}  // namespace sightcell::bake
