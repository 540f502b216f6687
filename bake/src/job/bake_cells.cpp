#include "job/bake_cells.h"

#include <utility>

namespace sightcell::bake {
namespace {

cell_list limited(cell_list list, const settings& how) {
  limit_cells(list, how.cell_limit, how.near);
  return list;
}

// Merged cells cover more than the cells that they were made from; --cell-limit leaves out cells of both.
std::optional<volume_grid> volumes_of(const bake_input& input, const cell_list& all, std::vector<view_cell> boxes,
                                      const settings& how) {
  if (how.volumes == 0.0 || input.cells) return std::nullopt;
  boxes.insert(boxes.end(), all.cells.begin(), all.cells.end());
  return std::optional<volume_grid>(std::in_place, boxes, how.volumes, double{how.margin});
}

}  // namespace

cell_list all_cells(const bake_input& input, const settings& how, const stop_request* stop) {
  return input.cells ? *input.cells : make_all_cells(input.geometry, how, stop);
}

bake_cells::bake_cells(const bake_input& input, cell_list all, std::vector<view_cell> boxes, const settings& how)
    : volumes(volumes_of(input, all, std::move(boxes), how)),
      list(limited(std::move(all), how)),
      blocks(list.cells, how.margin) {}

}  // namespace sightcell::bake
