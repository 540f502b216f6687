#include <tbb/task_arena.h>

#include <optional>

#include "cells/floors.h"
#include "job/bake_context.h"
#include "job/estimate.h"
#include "sightcell/bake/cells.h"

namespace sightcell::bake {

std::optional<cell_preview> preview_cells(const scene::scene& s, const settings& how, const callbacks& events) {
  validate(how);
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  std::optional<bake_context> context;
  callbacks quiet = events;
  quiet.on_message = {};
  if (!build(context, s, how, {}, {}, arena, quiet)) return std::nullopt;
  const cell_list& list = context->cells->list;
  if (events.on_phase) events.on_phase(bake_phase::estimating);
  const std::optional<bake_estimate> estimate = estimate_bake(*context, list.cells.size(), arena, quiet, true);
  if (!estimate) return std::nullopt;
  cell_preview preview{.cells = {},
                       .ground = {},
                       .floors = {},
                       .how = list.how,
                       .warnings = list.warnings,
                       .cpu_seconds = estimate->cpu_seconds,
                       .polygons_per_cell = estimate->polygons,
                       .file_bytes = estimate->file_bytes};
  preview.cells.reserve(list.cells.size());
  preview.ground.reserve(list.cells.size());
  for (const view_cell& cell : list.cells) {
    preview.ground.push_back(cell.floor);
    preview.cells.push_back({cell.name, {cell.min.x, cell.min.y, cell.min.z}, {cell.max.x, cell.max.y, cell.max.z}});
  }
  preview.floors = find_floors(list.cells, most_floors);
  return preview;
}

}  // namespace sightcell::bake
