#include "grid_boxes_writer.h"

#include <cstdint>

#include "byte_sink.h"
#include "packed_columns_writer.h"
#include "record_rules.h"
#include "sightcell/format/cell_lattice.h"

namespace sightcell::format {

bool put_grid(const lattice_shape& step, std::span<const grid_box> places, std::vector<std::byte>& out) {
  if (!shape_is_valid(step)) return false;
  std::vector<std::vector<std::uint32_t>> columns(6);
  for (const grid_box& p : places) {
    if (!box_is_valid(box_of(step, p))) return false;
    std::size_t column = 0;
    for (const std::uint32_t value :
         {from_signed(p.x), from_signed(p.y), from_signed(p.z), p.steps_x, p.steps_y, p.steps_z}) {
      columns[column++].push_back(value);
    }
  }
  byte_sink bytes(out);
  bytes.put_f64(step.width);
  bytes.put_f64(step.height);
  put_columns(columns, out);
  return true;
}

}  // namespace sightcell::format
