#pragma once
// Takes the steps of cells from the kept records of an earlier bake where an edit cannot have changed them, bakes the
// others, and keeps the records of all (docs/method/incremental.md).
#include <array>
#include <compare>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cell_set/cell_record.h"
#include "cells/view_cell.h"
#include "search/found_before.h"
#include "search/near_polygons.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"
#include "since/kept_records.h"
#include "since/scene_edit.h"
#include "touched/tested_viewpoints.h"
#include "touched/touched_space.h"

namespace sightcell::bake {

// Why a cell was baked again, of several reasons the largest.
enum class rebake_reason : std::uint8_t {
  none = 0,             // it was not
  neighbors = 1,        // the record of a neighbor changed
  something_new = 2,    // it could see where something new is
  changed_polygon = 3,  // it saw a polygon that changed, moved or is gone, or the place of one
  new_cell = 4,         // the earlier bake has no such cell
  started = 5,          // an earlier bake started it from what was found before it (settings::keep_found)
};

// Returns the records of the neighbors that go into a step.
using neighbor_records = std::function<std::span<const cell_record>()>;

// Bakes a step. before: what it starts from; null: it is baked as in a full bake.
using bake_step = std::function<cell_record(const found_before* before)>;

class step_keeper {
 public:
  // geometry, neighbors, how: of the bake; how must outlive the keeper. neighbors: null if the bake has none.
  // volumes: number of visibility volumes.
  // key: of the settings. Records of another key are refused.
  // before: the records of the earlier bake; nothing: all cells are new.
  // edit: of the geometry since before, with the hashes of neighbors.
  // Fails with records.other-bake.
  step_keeper(const scene::world_geometry& geometry, const near_polygons* neighbors, const settings& how,
              std::uint32_t volumes, std::string key, std::optional<kept_records> before, scene_edit edit);
  step_keeper(const step_keeper&) = delete;  // cells point into it
  step_keeper& operator=(const step_keeper&) = delete;

  // Returns the record of a step: the kept one, or that of bake().
  // own, neighbors: what goes into the step; own: null for the first step. Neighbors are not asked for where the result
  // does not depend on them.
  // bake: called at most once, on this thread, while rays and hemicubes are recorded.
  // Threads: may be called from several at a time.
  // Fails with records.damaged.
  cell_record take(const view_cell& cell, step_kind kind, const cell_record* own,
                   const neighbor_records& neighbors, const bake_step& bake);

  // Returns the number of cells for each reason, of those for which take() was called.
  std::array<std::uint32_t, 6> cells_by_reason() const;

  // Writes the records of all steps beside a .pvs file, under a name that is not final. Fails with output.io.
  std::unique_ptr<written_records> write(const std::filesystem::path& pvs);

 private:
  struct step_name {
    std::uint64_t place;
    std::array<float, 6> box;
    step_kind kind;
    auto operator<=>(const step_name&) const = default;
  };
  static std::vector<edited_part> parts_of(const std::vector<triangle>& all);
  static step_name name_of(const view_cell& cell, step_kind kind);
  bool meets(const touched_space& space, const std::vector<edited_part>& parts) const;
  std::uint64_t hash_of_set(const cell_record& record) const;
  std::uint64_t hash_of_own(const cell_record* own) const;
  std::uint64_t hash_of_neighbors(std::span<const cell_record> neighbors) const;
  rebake_reason why_not(const kept_step* step, const kept_step& now, cell_record& record) const;
  bool renumber(cell_record& record) const;
  void drop_gone(cell_record& record) const;
  std::optional<found_before> found_in(const view_cell& cell) const;
  void require_sound(const cell_record& record) const;
  touched_space space_of(std::span<const std::uint8_t> bytes) const;
  void put_spaces(const std::vector<std::vector<std::uint8_t>>& before, touched_space& own,
                  std::vector<std::vector<std::uint8_t>>& spaces) const;
  void note(const view_cell& cell, rebake_reason why, kept_step step);

  const settings& how_;
  const std::uint32_t volumes_;
  box scene_;
  kept_records before_, now_;
  polygon_edit edit_;
  std::vector<std::uint8_t> near_differs_;  // by old polygon: 1 if it is not gone and has other neighbors
  edited_triangles edited_;
  edited_boxes edited_boxes_;
  std::map<step_name, const kept_step*> steps_;
  std::set<step_name> cells_;                   // of before_, as of step_kind::sample
  mutable std::mutex mutex_;                    // of now_.steps and reasons_
  std::map<step_name, rebake_reason> reasons_;  // by cell, of step_kind::sample
};

}  // namespace sightcell::bake
