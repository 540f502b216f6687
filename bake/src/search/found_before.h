#pragma once
// What an earlier bake found in a cell, brought up to date after an edit of the scene: the start of a search that is
// much shorter than a new one (docs/method/incremental.md).
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cell_set/cell_record.h"
#include "cell_set/cell_set.h"
#include "search/certify.h"
#include "search/neighbor_check.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"
#include "trace/triangle_math.h"
#include "trace/triangle_tree.h"

namespace sightcell::bake {

// Triangles of an edit that are near each other, and their box.
struct edited_part {
  box where;
  std::vector<triangle> corners;
};

// What an edit removed and added.
struct edited_triangles {
  std::vector<edited_part> removed, added;
  triangle_tree all, of_added;  // for lines and lines beside them (reach_beside())
  box around_added;

  edited_triangles() = default;
  // smallest_gap: meters.
  edited_triangles(std::vector<edited_part> removed, std::vector<edited_part> added, float smallest_gap);
};

struct found_before {
  // The last record of the cell, with the polygon numbers of this scene and without polygons that are gone. Its
  // witnesses were valid viewpoints.
  cell_record record;
  const edited_triangles* edit = nullptr;  // since then; must outlive the object

  // The share of the verification rays of the record that missed; 1 if there were none.
  double missing() const {
    return record.rays > 0 ? static_cast<double>(record.misses) / static_cast<double>(record.rays) : 1.0;
  }
};

// Returns the share of the members that a set had before the edit which are left: those that are still in the scene,
// and that nothing which was added may occlude from their witness. corners: of all polygons of the scene. members: of
// the set before the edit.
double share_left(std::span<const triangle> corners, const found_before& before, std::size_t members);

// Adds the polygons of the record to the set, but for those of which something that was added may occlude all from
// their witness, and those whose witness is not valid any more. Casts no rays at polygons. Returns the number of tested
// viewpoints.
std::uint64_t join_found_before(const ray_scene& rays, const found_before& before, const visibility_rules& rules,
                                cell_set& set);

// Tries the polygons of the record that the set lacks from several viewpoints (neighbor_check.h), and adds those that a
// ray hits. Returns the number of rays.
std::uint64_t look_again(const ray_scene& rays, const box& grown, const found_before& before,
                         const neighbor_check_settings& how, cell_set& set);

// Casts rays from eyes of the set toward what was added and to where something was removed, in rounds, until a round
// finds next to nothing. Adds what they see. Returns the number of rays.
std::uint64_t look_at_edit(const ray_scene& rays, const found_before& before, const neighbor_check_settings& how,
                           cell_set& set);

// Returns the bound of the record, for rays that are cast again. Their results can have changed where something was
// edited, and where the record has polygons that the set lacks. Returns nothing if the record has no bound of known
// rays, or too little is left of its confidence for new ones.
// smallest_gap: meters.
std::optional<cast_again> bound_before(const ray_scene& rays, const found_before& before, float smallest_gap,
                                       const cell_set& set);

}  // namespace sightcell::bake
