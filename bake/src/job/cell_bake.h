#pragma once
// The work on one cell: valid viewpoints, sampling, polygons inside the cell, neighbor check, search and verification
// rays.
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
#include "search/found_before.h"
#include "search/near_polygons.h"
#include "search/neighbor_check.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

// The limits of one turn of a cell in a bake with a time budget.
struct cell_turn {
  double target = 1e-2;               // the turn ends when the bound is at most this
  std::uint64_t max_rays = 0;         // or when this many rays are spent
  const time_limit* limit = nullptr;  // or when this is reached; must not be null
};

// Where the search of a cell starts: that of a new cell, or what an earlier bake did.
struct search_start {
  std::size_t known = 0;  // members of the set whose neighbors were tried
  double missing = 1.0;   // see finish_settings
  std::optional<cast_again> again;
};

// Computes the records of cells. A record depends only on the settings, the scene, the box and the place of the cell,
// and the records that are passed in. The exceptions are limits of time.
//
// stop, in all calls: a request ends the step with step_stopped within a few tenths of a second. Null for none.
// set, in all calls: working memory, overwritten. It is as large as the scene (set_bytes()), so make it once per
// worker. Threads: several may call at the same time, each with a set of its own. All functions work on the calling
// thread's TBB arena.
class cell_baker {
 public:
  // References must outlive the baker.
  // neighbors: may be null if needs_neighbors(how) is false.
  // duplicates: of the scene.
  // sampler: prepared before the first cell.
  // metric: the metric of how.
  // misses: reported misses; null for none.
  // own_polygons: polygons from this number on are of another scene and in no set (two_scenes.h).
  // volumes: visibility volumes that are searched for too; null for none.
  cell_baker(const settings& how, const overrides& given, const ray_scene& rays, const near_polygons* neighbors,
             const duplicate_classes& duplicates, const cell_sampler& sampler,
             const error_metric& metric = pixel_metric, const reported_misses* misses = nullptr,
             std::uint32_t own_polygons = 0xFFFFFFFFu, const volume_grid* volumes = nullptr);
  cell_baker(const cell_baker&) = delete;  // sets point into it
  cell_baker& operator=(const cell_baker&) = delete;

  cell_set make_set() const;
  std::size_t set_bytes() const;

  // Phase 1, first round. Returns what the sampler finds and the polygons inside the cell.
  // before, here and in finish_rays(): what the cell starts from in place of samples; null: it is baked anew.
  cell_record sample(const view_cell& cell, cell_set& set, stop_request* stop = nullptr,
                     const found_before* before = nullptr) const;
  // Phase 1, second round. Checks the polygons of the neighbors, then searches with rays until verification rays bound
  // the miss probability.
  // own: the record of the first round.
  // neighbors: records of the first round of the neighbors in the cell's block.
  cell_record finish_rays(const view_cell& cell, const cell_record& own, std::span<const cell_record> neighbors,
                          cell_set& set, stop_request* stop = nullptr, const found_before* before = nullptr) const;
  // Both rounds of a cell that touches no other cell of its block.
  cell_record sample_and_finish(const view_cell& cell, cell_set& set, stop_request* stop = nullptr,
                                const found_before* before = nullptr) const;
  // Phase 2. Checks the polygons that the neighbors in all blocks have after phase 1. Only adds to the set, so the
  // bound still holds. limit: of a time budget; null: that of the settings.
  cell_record check(const view_cell& cell, const cell_record& own, std::span<const cell_record> neighbors,
                    cell_set& set, stop_request* stop = nullptr, const time_limit* limit = nullptr) const;
  // Phase 2 of a cell that starts from what an earlier bake found, neighbors included. Adds what the check found then.
  cell_record keep_checked(const cell_record& own, const found_before& before, cell_set& set,
                           stop_request* stop = nullptr) const;
  // One turn of a cell in a bake with a time budget: neighbor check, search and verification rays. The set does not
  // shrink and the bound does not rise.
  // before: the record of the turn before; null for the first turn, which samples first.
  // neighbors: the current records of the neighbors.
  cell_record improve(const view_cell& cell, const cell_record* before, std::span<const cell_record> neighbors,
                      const cell_turn& turn, cell_set& set) const;
  // Returns the record for the file: adds the overrides of the cells file, coarser levels of detail and the
  // conservative dilation to the last record of the functions above. Drops the witnesses.
  cell_record finished(const view_cell& cell, cell_record last) const;

  // Returns true if cells check what their neighbors found. Without verification rays they do not.
  bool shares() const { return how_.max_pixel_error > 0.0; }

 private:
  visibility_rules rules() const { return {how_.player_radius, how_.smallest_gap}; }
  box grown(const view_cell& cell) const { return box{cell.min, cell.max}.grown(how_.margin); }
  viewpoint_region region_of(const view_cell& cell, const cell_record& record) const;
  void add_inside(const view_cell& cell, const std::vector<std::uint32_t>& inside,
                  const std::vector<glm::vec3>& viewpoints, cell_set& set) const;
  void add_misses(const view_cell& cell, cell_set& set, cell_record& record) const;
  void complete(const view_cell& cell, std::vector<std::uint32_t>& set) const;
  search_start start_from(const view_cell& cell, const found_before& before, const time_limit& limit, cell_set& set,
                          cell_record& record) const;
  std::optional<search_views> views_of(const view_cell& cell, const cell_record& record) const;
  finish_result finish(const view_cell& cell, finish_settings how, std::optional<search_views>& views, cell_set& set,
                       cell_record& record) const;
  void bound(const view_cell& cell, const time_limit& limit, const search_start& start, cell_set& set,
             cell_record& record) const;
  neighbor_check_settings check_of(const view_cell& cell, purpose use, const time_limit& limit) const;
  cell_record sample(const view_cell& cell, cell_set& set, const time_limit& limit,
                     const found_before* before = nullptr) const;
  time_limit limit_until(double share, const cell_record& record, stop_request* stop) const;
  void note_time(const time_limit& limit, cell_record& record) const;

  const settings& how_;
  const overrides& given_;
  const ray_scene& rays_;
  const near_polygons* neighbors_;
  const duplicate_classes& duplicates_;
  const cell_sampler& sampler_;
  const error_metric& metric_;
  const reported_misses* misses_;
  const std::uint32_t own_polygons_;
  const volume_grid* volumes_;
  std::vector<std::uint32_t> always_;  // polygons that are in every set
};

}  // namespace sightcell::bake
