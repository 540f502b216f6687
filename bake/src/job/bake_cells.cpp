#include "job/bake_cells.h"

namespace sightcell::bake {
namespace {

cell_list make_list(const bake_input& input, const settings& how, std::optional<volume_grid>& volumes) {
  if (input.cells) return *input.cells;
  cell_list list = make_all_cells(input.geometry, how);
  if (how.volumes > 0.0) volumes.emplace(list.cells, how.volumes, double{how.margin});
  limit_cells(list, how.cell_limit);
  return list;
}

}  // namespace

bake_cells::bake_cells(const bake_input& input, const settings& how)
    : volumes(), list(make_list(input, how, volumes)), blocks(list.cells, how.margin) {}

}  // namespace sightcell::bake
