#include <tbb/task_arena.h>

#include <optional>

#include "job/bake_context.h"
#include "sightcell/bake/cells.h"

namespace sightcell::bake {

std::optional<cell_preview> preview_cells(const scene::scene& s, const settings& how, const callbacks& events) {
  validate(how);
  tbb::task_arena arena(how.threads == 0 ? tbb::task_arena::automatic : static_cast<int>(how.threads));
  std::optional<bake_context> context;
  callbacks quiet = events;
  quiet.on_message = {};
  if (!build(context, s, how, arena, quiet)) return std::nullopt;
  const cell_list& list = context->cells->list;
  cell_preview preview{.cells = {}, .how = list.how, .warnings = list.warnings};
  preview.cells.reserve(list.cells.size());
  for (const view_cell& cell : list.cells)
    preview.cells.push_back({cell.name, {cell.min.x, cell.min.y, cell.min.z}, {cell.max.x, cell.max.y, cell.max.z}});
  return preview;
}

}  // namespace sightcell::bake
